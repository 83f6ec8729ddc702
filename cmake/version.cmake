# Tell the program what it is: configures the module coulter_version into ${version_module}.
# A commit or checkout changes .git/logs/HEAD, which makes CMake run again.
set(git_revision "unknown")
if(EXISTS ${PROJECT_SOURCE_DIR}/.git/logs/HEAD)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS .git/logs/HEAD)
endif()
find_package(Git QUIET)
if(GIT_FOUND AND EXISTS ${PROJECT_SOURCE_DIR}/.git)
  execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --short=12 HEAD
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(revision)
    set(git_revision ${revision})
  endif()
endif()

string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
string(STRIP "${CMAKE_Fortran_FLAGS} ${CMAKE_Fortran_FLAGS_${build_type}}" version_flags)
string(REPLACE " -" "\" // &\n      \" -" version_flags "${version_flags}")  # one flag a line
set(version_module ${PROJECT_BINARY_DIR}/generated/version.f90)
configure_file(${PROJECT_SOURCE_DIR}/cmake/version.f90.in ${version_module} @ONLY)
