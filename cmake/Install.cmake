# cmake --install, the CMake package that others find, and the Debian package (cpack, or cmake --build --target package).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS heartservo RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/heartservo)
install(FILES README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES tools/setup/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME heartservo)

# find_package(heartservo): heartservo::tracking, heartservo::servo, heartservo::sim
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/heartservo)
install(TARGETS heartservo_tracking heartservo_servo heartservo_sim EXPORT heartservoTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY tracking servo sim DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/heartservo FILES_MATCHING PATTERN *.hpp)
install(EXPORT heartservoTargets NAMESPACE heartservo:: DESTINATION ${package_dir})
list(JOIN HEARTSERVO_VISP_COMPONENTS " " HEARTSERVO_VISP_LIST)
configure_package_config_file(cmake/heartservoConfig.cmake.in ${PROJECT_BINARY_DIR}/heartservoConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/heartservoConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/heartservoConfig.cmake ${PROJECT_BINARY_DIR}/heartservoConfigVersion.cmake
              cmake/FindViSP.cmake DESTINATION ${package_dir})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "heartservo developers <heartservo@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
include(CPack)
