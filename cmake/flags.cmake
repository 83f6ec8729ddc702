# Compiler flags per build type, and the warnings as a target that only our own code links.
if(NOT CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
  message(WARNING "Coulter is developed with gfortran; flags for other compilers are theirs.")
  add_library(coulter_warnings INTERFACE)
  return()
endif()

set(CMAKE_CONFIGURATION_TYPES Release Debug Coverage)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

# Never -Ofast: it removes the checks for NaN.
set(CMAKE_Fortran_FLAGS_RELEASE "-O3 -fno-math-errno")
if(COULTER_NATIVE)
  string(APPEND CMAKE_Fortran_FLAGS_RELEASE " -march=native")
endif()
string(CONCAT CMAKE_Fortran_FLAGS_DEBUG
  "-Og -g -fbacktrace -fcheck=all,no-array-temps -ffpe-trap=invalid,zero,overflow "
  "-finit-real=snan -finit-derived")
set(CMAKE_Fortran_FLAGS_COVERAGE "-O0 -g --coverage")
set(CMAKE_C_FLAGS_COVERAGE "-O0 -g --coverage")
set(CMAKE_EXE_LINKER_FLAGS_COVERAGE "--coverage")

# -Wconversion-extra is the only flag that sees a single-precision constant used as double.
# gfortran 12 takes the bounds of its own temporaries for uninitialised, hence
# -Wno-uninitialized; the debug preset finds real cases by signalling NaN. An overriding procedure
# need not look at all that its interface offers, hence -Wno-unused-dummy-argument.
add_library(coulter_warnings INTERFACE)
target_compile_options(coulter_warnings INTERFACE
  $<$<COMPILE_LANGUAGE:Fortran>:-std=f2018 -pedantic -fimplicit-none -Wall -Wextra
  -Wimplicit-interface -Wimplicit-procedure -Wuse-without-only -Wconversion-extra
  -Wno-maybe-uninitialized -Wno-uninitialized -Wno-unused-dummy-argument
  $<$<BOOL:${COULTER_WERROR}>:-Werror>>)
