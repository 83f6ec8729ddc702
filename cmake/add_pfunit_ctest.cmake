# add_pfunit_ctest(name TEST_SOURCES a.pf ... [LINK_LIBRARIES ...])
#
# Stands in for pFUnit's function of that name where pFUnit is not installed: builds one program
# from the .pf files with the substitute in tests/support/funit and adds it as one ctest row.
set(funit_dir ${PROJECT_SOURCE_DIR}/tests/support/funit)
add_library(funit STATIC
  ${funit_dir}/funit.f90
  ${funit_dir}/funit_basic.f90
  ${funit_dir}/funit_core.f90
  ${funit_dir}/funit_typed.f90)
set_property(SOURCE ${funit_dir}/funit_typed.f90 PROPERTY OBJECT_DEPENDS
  "${funit_dir}/funit_real.inc;${funit_dir}/funit_integer.inc")
set_target_properties(funit PROPERTIES
  Fortran_MODULE_DIRECTORY ${PROJECT_BINARY_DIR}/tests/funit)
target_include_directories(funit PUBLIC ${PROJECT_BINARY_DIR}/tests/funit)

function(add_pfunit_ctest name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "TEST_SOURCES;LINK_LIBRARIES")
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${name}.dir)
  set(suite_calls "")
  set(sources ${folder}/driver.f90)
  foreach(source IN LISTS arg_TEST_SOURCES)
    cmake_path(ABSOLUTE_PATH source)
    cmake_path(GET source STEM stem)
    add_custom_command(OUTPUT ${folder}/${stem}.F90
      COMMAND ${COULTER_PYTHON} ${funit_dir}/preprocess.py ${source} ${folder}/${stem}.F90
      DEPENDS ${source} ${funit_dir}/preprocess.py
      COMMENT "Expanding ${stem}.pf" VERBATIM)
    list(APPEND sources ${folder}/${stem}.F90)
    string(APPEND suite_calls "   call ${stem}_suite()\n")
  endforeach()
  file(CONFIGURE OUTPUT ${folder}/driver.f90 @ONLY CONTENT "program driver
   use funit, only: finish_run
   implicit none

@suite_calls@   call finish_run()
end program driver
")
  add_executable(${name} ${sources})
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY ${folder}/modules)
  target_include_directories(${name} PRIVATE ${folder}/modules)
  target_link_libraries(${name} PRIVATE funit ${arg_LINK_LIBRARIES})
  add_test(NAME ${name} COMMAND ${name})
endfunction()
