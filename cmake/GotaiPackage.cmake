# What `cmake --install` writes so that others can find_package(gotai).
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/gotai)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/gotaiConfig.cmake.in
  ${PROJECT_BINARY_DIR}/gotaiConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/gotaiConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(EXPORT gotaiTargets NAMESPACE gotai:: DESTINATION ${package_dir})
install(FILES ${PROJECT_BINARY_DIR}/gotaiConfig.cmake ${PROJECT_BINARY_DIR}/gotaiConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/GotaiDependencies.cmake DESTINATION ${package_dir})
