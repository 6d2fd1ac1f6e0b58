# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` puts where, the CMake package for other projects, and the .deb of CPack.
# Component runtime: the program with its schemas, cells and samples. Component development: headers and libraries.
include(CMakePackageConfigHelpers)

install(TARGETS millpose RUNTIME COMPONENT runtime)
set(share ${CMAKE_INSTALL_DATADIR}/millpose)
install(DIRECTORY cells toolpaths DESTINATION ${share} COMPONENT runtime
        PATTERN "*.py" EXCLUDE PATTERN "*.out" EXCLUDE)
# Where the editor lines of cells and samples look for them.
install(DIRECTORY docs/schema DESTINATION ${share}/docs COMPONENT runtime)
install(FILES README.md CHANGELOG.md lib/report/web/three-license.txt DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT runtime)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime
        FILES_MATCHING PATTERN "*.md" PATTERN "*.yml" PATTERN "*.py" PATTERN schema EXCLUDE)

set(documents ${PROJECT_BINARY_DIR}/apps/millpose)
install(FILES ${documents}/millpose.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
install(FILES ${documents}/millpose.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME millpose COMPONENT runtime)

# What users include, as <millpose/objective.hpp>; beside it what these include.
install(DIRECTORY lib/millpose DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(DIRECTORY lib/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/millpose/internal COMPONENT development
        FILES_MATCHING PATTERN "*.hpp" PATTERN "*_adapter.hpp" EXCLUDE PATTERN fcl_part.hpp EXCLUDE
        PATTERN pch.hpp EXCLUDE PATTERN web EXCLUDE PATTERN millpose EXCLUDE)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/millpose)
install(EXPORT millpose NAMESPACE millpose:: FILE millposeTargets.cmake DESTINATION ${package} COMPONENT development)
configure_package_config_file(apps/install/millposeConfig.cmake.in ${PROJECT_BINARY_DIR}/millposeConfig.cmake
                              INSTALL_DESTINATION ${package} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/millposeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/millposeConfig.cmake ${PROJECT_BINARY_DIR}/millposeConfigVersion.cmake
        DESTINATION ${package} COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME millpose)
set(CPACK_PACKAGE_CONTACT "millpose developers <millpose@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME millpose)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "A workpiece YAML in, robot programs for KRL, SINUMERIK and LinuxCNC out: each
milling point in the pose in which a six-axis arm is stiffest in the milling
plane.")
include(CPack)
