include(CMakePackageConfigHelpers)

# Two parts: `program` is what the Debian package holds, `development` the library for other programs.
get_property(libs GLOBAL PROPERTY PELLICLE_LIBRARIES)
install(TARGETS ${libs} EXPORT pellicleTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(EXPORT pellicleTargets NAMESPACE pellicle:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellicle
        COMPONENT development)
configure_package_config_file(cmake/pellicleConfig.cmake.in ${CMAKE_BINARY_DIR}/pellicleConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellicle)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/pellicleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/pellicleConfig.cmake ${CMAKE_BINARY_DIR}/pellicleConfigVersion.cmake
        cmake/PellicleDependencies.cmake cmake/FindCHOLMOD.cmake cmake/FindOpenSubdiv.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pellicle COMPONENT development)

install(DIRECTORY presets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/pellicle/presets COMPONENT program
        FILES_MATCHING PATTERN "*.toml")
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES third_party/niivue/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME LICENSE.niivue COMPONENT program)
install(FILES packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(PROGRAMS packaging/slicer/Pellicle DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/pellicle/slicer COMPONENT program)

set(described ${CMAKE_BINARY_DIR}/described)  # see cli/CMakeLists.txt
install(DIRECTORY ${described}/man1/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${described}/pellicle DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES ${described}/pellicle-segment.json DESTINATION ${CMAKE_INSTALL_DATADIR}/pellicle/boutiques
        COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_NAME pellicle)
set(CPACK_PACKAGE_VENDOR "The Pellicle authors")
set(PELLICLE_CONTACT "The Pellicle authors <pellicle@example.org>" CACHE STRING "Maintainer of the package")
set(CPACK_PACKAGE_CONTACT ${PELLICLE_CONTACT})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "smooth closed surfaces around objects in 3D biomedical images")
set(CPACK_PACKAGE_DESCRIPTION
"Pellicle finds one object, or every one of many, in a 3D biomedical image and
wraps a smooth closed surface around it, a few-parameter deformable surface.
From the surface come a mask, a mesh, a model that re-creates it exactly, a
report and a picture. It reads NIfTI, NRRD, MetaImage, TIFF and DICOM series,
and works as a module of 3D Slicer and on BIDS datasets.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
include(CPack)
