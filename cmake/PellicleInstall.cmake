include(CMakePackageConfigHelpers)
get_property(libs GLOBAL PROPERTY PELLICLE_LIBRARIES)
install(TARGETS ${libs} EXPORT pellicleTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT pellicleTargets NAMESPACE pellicle:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellicle)
configure_package_config_file(cmake/pellicleConfig.cmake.in ${CMAKE_BINARY_DIR}/pellicleConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellicle)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/pellicleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/pellicleConfig.cmake ${CMAKE_BINARY_DIR}/pellicleConfigVersion.cmake
        cmake/PellicleDependencies.cmake cmake/FindOpenSubdiv.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellicle)
install(DIRECTORY presets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/pellicle/presets FILES_MATCHING PATTERN "*.toml")
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES third_party/niivue/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME LICENSE.niivue)
