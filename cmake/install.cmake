# Installs the program, the library with its .mod files, and what others need to find them.
include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/coulter)

# a shared library is found from the program, wherever the installation is moved
if(BUILD_SHARED_LIBS)
  file(RELATIVE_PATH bin_to_lib ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
  set_target_properties(coulter_program PROPERTIES INSTALL_RPATH $ORIGIN/${bin_to_lib})
endif()
install(TARGETS coulter_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS coulter EXPORT coulter-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_BINARY_DIR}/modules/ DESTINATION ${module_install_dir}
  FILES_MATCHING PATTERN "*.mod")
install(FILES ${PROJECT_SOURCE_DIR}/include/umat/ABA_PARAM.INC
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/coulter/umat)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/licenses/coulter)

# find_package(coulter) -> coulter::coulter
install(EXPORT coulter-targets NAMESPACE coulter:: DESTINATION ${config_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/coulter-config.cmake.in
  ${PROJECT_BINARY_DIR}/generated/coulter-config.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/coulter-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/generated/coulter-config.cmake
  ${PROJECT_BINARY_DIR}/generated/coulter-config-version.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindUMFPACK.cmake
  DESTINATION ${config_dir})

# pkg-config coulter; its paths are relative, so that the installation can be moved
file(RELATIVE_PATH pkgconfig_to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(${PROJECT_SOURCE_DIR}/cmake/coulter.pc.in
  ${PROJECT_BINARY_DIR}/generated/coulter.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/generated/coulter.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
