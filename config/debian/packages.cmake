# Debian packages, one for each component of what is installed; tools/package makes them.
include(GNUInstallDirs)
set(packages daemon:odoless tools:odoless-tools types:odoless-lcm-types dev:libodoless-dev)

# What each package has to have: its licence and its history.
set(debian ${CMAKE_CURRENT_LIST_DIR})
file(READ ${debian}/changelog changelog)
string(REGEX MATCH "^odoless \\(([^)]+)\\)" _ "${changelog}")
if(NOT CMAKE_MATCH_1 STREQUAL PROJECT_VERSION)
  message(FATAL_ERROR "config/debian/changelog is of version ${CMAKE_MATCH_1}; must be ${PROJECT_VERSION}, of CMakeLists.txt")
endif()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${debian}/changelog)
set(changelog_gz ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz)
execute_process(COMMAND gzip -9nc ${debian}/changelog OUTPUT_FILE ${changelog_gz} COMMAND_ERROR_IS_FATAL ANY)
foreach(entry IN LISTS packages)
  string(REPLACE ":" ";" entry ${entry})
  list(GET entry 0 component)
  list(GET entry 1 package)
  set(doc ${CMAKE_INSTALL_DATADIR}/doc/${package})
  install(FILES ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION ${doc} RENAME copyright COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${changelog_gz} DESTINATION ${doc} COMPONENT ${component} EXCLUDE_FROM_ALL)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  string(TOUPPER ${component} COMPONENT)
  set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME ${package})
endforeach()

# The configuration of the service. Only a package may write there: it asks before it overwrites.
install(FILES ${CMAKE_SOURCE_DIR}/config/robot.toml DESTINATION /etc/odoless COMPONENT daemon EXCLUDE_FROM_ALL)

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${debian}/before_packing.cmake)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The odoless maintainers <odoless@debian.invalid>")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  cmake_path(GET LCM_LIBRARY PARENT_PATH CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS)
endif()
set(CPACK_ODOLESS_STRIP ${CMAKE_STRIP})
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(CPACK_DEBIAN_DAEMON_PACKAGE_SECTION science)
set(CPACK_COMPONENT_DAEMON_DESCRIPTION "The daemon: reads one laser range finder and nothing else, knows where the
robot is, builds its map, and publishes both over LCM. Runs as the service
odolessd, with a user, udev rules and a configuration.")
set(CPACK_DEBIAN_DAEMON_PACKAGE_DEPENDS "systemd | systemd-standalone-sysusers, passwd")
set(CPACK_DEBIAN_DAEMON_PACKAGE_RECOMMENDS odoless-tools)
set(CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_EXTRA ${debian}/postinst ${debian}/prerm ${debian}/postrm ${debian}/conffiles)
set(CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "The command line: maps recorded logs with the laser alone, evaluates
trajectories, simulates and emulates lasers, and asks and commands the daemon.")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "odoless, odoless-lcm-types, gnuplot-nox")

set(CPACK_DEBIAN_TYPES_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TYPES_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_TYPES_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_TYPES_PACKAGE_SUGGESTS liblcm-bin)
set(CPACK_COMPONENT_TYPES_DESCRIPTION "The types of the LCM messages that the daemon publishes and takes, for
lcm-gen to make code of in C++, Python, Java and more.")

set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS libeigen3-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "libfmt-dev, libtomlplusplus-dev, libusb-1.0-0-dev, libgpiod-dev, pkg-config")
set(CPACK_COMPONENT_DEV_DESCRIPTION "Static libraries for C++: the method (scan matching by NDT and Differential
Evolution, laser odometry, DP-SLAM and a pose graph), real-time building blocks,
and drivers of laser range finders and tilt servos; and a library for C.")

# Debug symbols in packages of their own, where the build has some; programs are stripped in either case.
set(CPACK_STRIP_FILES ON)
if(CMAKE_CXX_FLAGS MATCHES "-g")
  set(CPACK_STRIP_FILES OFF)
  set(CPACK_DEBIAN_DAEMON_DEBUGINFO_PACKAGE ON)
  set(CPACK_DEBIAN_TOOLS_DEBUGINFO_PACKAGE ON)
endif()
include(CPack)
