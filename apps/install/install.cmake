# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` puts where, the CMake package for other projects, and the .deb of CPack.
# Component runtime: the program with its schemas, cells and samples. Component python: the Python package. Component
# development: headers and libraries.
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

# Where Debian's python3 looks for packages below /usr.
install(DIRECTORY apps/python/millpose DESTINATION lib/python3/dist-packages COMPONENT python
        FILES_MATCHING PATTERN "*.py" PATTERN __pycache__ EXCLUDE)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-millpose RENAME copyright COMPONENT python)

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
set(CPACK_COMPONENTS_ALL runtime python)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME millpose)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "A workpiece YAML in, robot programs for KRL, SINUMERIK and LinuxCNC out: each
milling point in the pose in which a six-axis arm is stiffest in the milling
plane.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-millpose)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy, millpose (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Plans and stiffness of millpose as numpy arrays, by running the program.")
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # `ninja millpose` builds what is packed; not the tests too
include(CPack)
