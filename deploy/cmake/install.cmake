# Files next to the programs, in the build folder and in an installation
# (core/types/program_folder.hpp), and the content of `cmake --install` and of the package.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(here ${CMAKE_INSTALL_DATADIR}/voxtouch)

# Scenes, meshes, device files, the page. In the build folder they are links, so that an edit needs
# no build.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/voxtouch ${PROJECT_BINARY_DIR}/installed
  ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
foreach(folder deploy/scenes deploy/meshes deploy/devices nodes/view/page)
  get_filename_component(name ${folder} NAME)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${PROJECT_BINARY_DIR}/share/voxtouch/${name}
    SYMBOLIC)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${here} PATTERN "*.py" EXCLUDE)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/deploy/services DESTINATION ${here} PATTERN "try" EXCLUDE)
# In share/voxtouch the paths of the READMEs are valid too.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/installed/deploy)
foreach(name scenes meshes devices services)
  file(CREATE_LINK ../${name} ${PROJECT_BINARY_DIR}/installed/deploy/${name} SYMBOLIC)
  install(FILES ${PROJECT_BINARY_DIR}/installed/deploy/${name} DESTINATION ${here}/deploy)
endforeach()
# The messages: voxtouch_msgs, a package for the src/ of a ROS 2 workspace, which the tool that
# draws reads too.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/idl DESTINATION ${here} PATTERN "__pycache__" EXCLUDE)

# Programs.
install(TARGETS voxtouch voxtouch_device_program voxtouch_rendering_program
  voxtouch_coupling_program voxtouch_logger_program
  voxtouch_validator_program voxtouch_import_mesh_program voxtouch_fri_controller voxtouch_fci_robot
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS voxtouch_hd_sim LIBRARY DESTINATION lib/voxtouch)
# The drawing tool is Python, next to its modules, with a link next to the programs.
set(tools ${PROJECT_SOURCE_DIR}/deploy/tools)
install(PROGRAMS ${tools}/plot.py DESTINATION ${here}/deploy/tools)
install(FILES ${tools}/plot_style.py ${tools}/plot_layout.py ${tools}/plot_accuracy.py
  ${tools}/plot_design.py ${tools}/plot_forces.py ${tools}/plot_identify.py ${tools}/bag_data.py
  ${tools}/bag_files.py ${tools}/run_data.py ${tools}/run_pictures.py ${tools}/run_page.py
  ${tools}/voxtouch.rviz ${tools}/voxtouch.foxglove.json DESTINATION ${here}/deploy/tools)
file(CREATE_LINK ${tools}/plot.py ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/voxtouch_plot SYMBOLIC)
file(CREATE_LINK ../share/voxtouch/deploy/tools/plot.py
  ${PROJECT_BINARY_DIR}/installed/voxtouch_plot SYMBOLIC)
install(FILES ${PROJECT_BINARY_DIR}/installed/voxtouch_plot DESTINATION ${CMAKE_INSTALL_BINDIR})

# Completion: bash loads a file by the command's name, zsh every file of a folder.
install(FILES ${PROJECT_SOURCE_DIR}/deploy/completion/voxtouch.bash
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME voxtouch)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/completion/_voxtouch
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
# Man pages, from --help of the installed programs.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(documented voxtouch voxtouch_device voxtouch_rendering voxtouch_coupling voxtouch_logger
  voxtouch_validator voxtouch_fri_controller voxtouch_fci_robot)
install(CODE "execute_process(
  COMMAND \"${Python3_EXECUTABLE}\" -B \"${tools}/man_page.py\"
  \"${CMAKE_RUNTIME_OUTPUT_DIRECTORY}\" \"${PROJECT_BINARY_DIR}/man\" ${documented}
  COMMAND_ERROR_IS_FATAL ANY)")
install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

# Libraries: find_package(voxtouch), targets by module.
set(libraries voxtouch_root voxtouch_reproducible)
foreach(module types mesh mesh_import exact voxmap pointshell contact effects coupling
  coupling_design absolute_stability scene device_mapping plan rendering device_fit
    reference accuracy accuracy_advice scene_proposal devices)
  set_target_properties(voxtouch_${module} PROPERTIES EXPORT_NAME ${module})
  list(APPEND libraries voxtouch_${module})
endforeach()
set_target_properties(voxtouch_root PROPERTIES EXPORT_NAME root)
set_target_properties(voxtouch_reproducible PROPERTIES EXPORT_NAME reproducible)
install(TARGETS ${libraries} EXPORT voxtouch ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/voxtouch)
foreach(folder core devices)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder}
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/voxtouch
    FILES_MATCHING PATTERN "*.hpp"
    PATTERN "simulated" EXCLUDE)
endforeach()
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/voxtouch)
install(EXPORT voxtouch NAMESPACE voxtouch:: FILE voxtouch-targets.cmake DESTINATION ${config})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/voxtouch-config.cmake.in
  ${PROJECT_BINARY_DIR}/voxtouch-config.cmake
  INSTALL_DESTINATION ${config})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/voxtouch-config-version.cmake COMPATIBILITY
  SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/voxtouch-config.cmake
  ${PROJECT_BINARY_DIR}/voxtouch-config-version.cmake
  DESTINATION ${config})
