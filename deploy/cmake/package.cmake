# The package for Debian 12: `cpack -G DEB` in the build folder, or deploy/package/build.
# install.cmake defines its content.
set(CPACK_PACKAGE_NAME voxtouch)
set(CPACK_PACKAGE_VENDOR voxtouch)
set(CPACK_PACKAGE_CONTACT "the authors of voxtouch <voxtouch@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "feel a mesh scene through a force-feedback device")
set(CPACK_PACKAGE_DESCRIPTION
  "Processes for rendering, coupling, device and logger form a ring over DDS.
Contacts come from voxmaps and pointshells, the coupling from a design with
certificates; simulated devices stand in for real ones.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # every library by its package
# The page's libraries are no link of any program's.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libjs-three, libjs-dygraphs")
# pictures, also of bags in MCAP
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3, python3-matplotlib, python3-zstandard")
# find_package(voxtouch)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
  "cmake, g++, libeigen3-dev, libfmt-dev, libyaml-cpp-dev, nlohmann-json3-dev, libpugixml-dev, \
libassimp-dev, libgeos-dev, libfcl-dev")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/deploy/package/postinst
  ${PROJECT_SOURCE_DIR}/deploy/package/prerm
  ${PROJECT_SOURCE_DIR}/deploy/package/postrm ${PROJECT_BINARY_DIR}/conffiles)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# Files that only a package may place outside of its prefix.
file(WRITE ${PROJECT_BINARY_DIR}/conffiles "/etc/security/limits.d/99-voxtouch-realtime.conf\n")
install(FILES ${PROJECT_SOURCE_DIR}/deploy/services/99-voxtouch-realtime.conf
  DESTINATION /etc/security/limits.d COMPONENT system EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/devices/99-voxtouch-phantom.rules
  DESTINATION lib/udev/rules.d COMPONENT system EXCLUDE_FROM_ALL)
# Services, installed but not enabled: their settings are in /etc/voxtouch.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/deploy/services/
  DESTINATION lib/systemd/system COMPONENT system EXCLUDE_FROM_ALL
  FILES_MATCHING PATTERN "voxtouch*" PATTERN "10-common.conf")
install(DIRECTORY DESTINATION /etc/voxtouch COMPONENT system EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/services/rig.conf
  DESTINATION share/doc/voxtouch/examples COMPONENT system EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/package/copyright
  DESTINATION share/doc/voxtouch COMPONENT system EXCLUDE_FROM_ALL)
# The READMEs with their pictures, by folder, so that their links are valid.
set(readmes README.md)
foreach(folder core deploy devices idl nodes qos tests)
  file(GLOB_RECURSE more RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS
    ${PROJECT_SOURCE_DIR}/${folder}/*.md)
  list(APPEND readmes ${more})
endforeach()
foreach(file IN LISTS readmes)
  get_filename_component(folder ${file} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/${file}
    DESTINATION share/doc/voxtouch/${folder} COMPONENT system EXCLUDE_FROM_ALL)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/deploy/pictures
  DESTINATION share/doc/voxtouch/deploy COMPONENT system EXCLUDE_FROM_ALL)
find_program(GZIP gzip REQUIRED)
execute_process(COMMAND ${GZIP} -9n -c ${PROJECT_SOURCE_DIR}/deploy/CHANGELOG.md OUTPUT_FILE
  ${PROJECT_BINARY_DIR}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
install(FILES ${PROJECT_BINARY_DIR}/changelog.gz
  DESTINATION share/doc/voxtouch COMPONENT system EXCLUDE_FROM_ALL)
set(CPACK_COMPONENTS_ALL Unspecified system)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
include(CPack)
