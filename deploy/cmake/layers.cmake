# The layers of the project, checked at configure time: nodes -> qos, idl, devices, core; devices ->
# core/types; core -> nothing above itself. Only core/mesh/import*, core/reference may see assimp;
# of core only core/scene yaml-cpp, of devices only the hand file; only core/reference FCL;
# core/reference sees no rendering code.
function(voxtouch_forbid_includes folder pattern reason)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.hpp
    ${PROJECT_SOURCE_DIR}/${folder}/*.cpp
       ${PROJECT_SOURCE_DIR}/${folder}/*.h ${PROJECT_SOURCE_DIR}/${folder}/*.c)
  foreach(allowed IN LISTS ARGN)
    list(FILTER files EXCLUDE REGEX "${allowed}")
  endforeach()
  foreach(file IN LISTS files)
    file(STRINGS ${file} hits REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"](${pattern})")
    if(hits)
      list(GET hits 0 first)
      file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${file})
      message(FATAL_ERROR "${name} has '${first}': ${reason}")
    endif()
  endforeach()
endfunction()

voxtouch_forbid_includes(core "dds|qos/|nodes/|devices/|voxtouch_msgs|idl/"
  "core is arithmetic and sees no layer above itself.")
voxtouch_forbid_includes(core "assimp/" "assimp belongs to the mesh readers only."
  "/core/mesh/import" "/core/reference/")
voxtouch_forbid_includes(core "geos" "GEOS belongs to the cutter of polygons only."
  "/core/mesh/polygon")
voxtouch_forbid_includes(core "yaml-cpp/" "the YAML parser belongs to core/scene only."
  "/core/scene/")
voxtouch_forbid_includes(core "fcl/" "FCL belongs to core/reference only." "/core/reference/")
voxtouch_forbid_includes(core/reference
  "core/(mesh|voxmap|pointshell|contact|exact|effects|coupling)/"
  "the reference links no rendering code: it would repeat the faults it has to find.")
voxtouch_forbid_includes(devices
  "dds|qos/|nodes/|voxtouch_msgs|idl/|\
core/(mesh|voxmap|pointshell|contact|effects|coupling|scene|reference)/"
  "a device driver sees the value types of core/types and nothing else of the project.")
voxtouch_forbid_includes(devices "yaml-cpp/" "only the hand file is YAML."
  "/devices/operator/hand_file")
voxtouch_forbid_includes(qos "nodes/|devices/|core/" "qos is tables over idl.")

# Nodes write to stderr through nodes/console only: any other path throws or blocks if stderr is
# blocked.
file(GLOB_RECURSE speaking CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/nodes/*.hpp
  ${PROJECT_SOURCE_DIR}/nodes/*.cpp)
list(FILTER speaking EXCLUDE REGEX "/nodes/console/")
foreach(file IN LISTS speaking)
  file(STRINGS ${file} hits REGEX
    "fmt::print\\(|std::(cerr|cout|clog)|printf\\(std(err|out)|perror\\(")
  if(hits)
    list(GET hits 0 first)
    message(FATAL_ERROR "${file} has '${first}': use console::log or console::print_result.")
  endif()
endforeach()
