# Raw CDR of any keyless topic. The sertype/serdata interface is internal to Cyclone DDS and differs between releases, hence
# the pinned version: a newer one needs nodes/bus/opaque_serdata.cpp read again, not only compiled.
find_package(CycloneDDS 0.10.2 REQUIRED)
if(NOT CycloneDDS_VERSION VERSION_LESS 0.11)
  message(FATAL_ERROR "nodes/bus/opaque_serdata.cpp is written against Cyclone DDS 0.10, found ${CycloneDDS_VERSION}.")
endif()
add_library(voxtouch_bus_opaque STATIC
  ${CMAKE_CURRENT_LIST_DIR}/opaque.cpp
  ${CMAKE_CURRENT_LIST_DIR}/opaque_discovery.cpp
  ${CMAKE_CURRENT_LIST_DIR}/opaque_qos.cpp
  ${CMAKE_CURRENT_LIST_DIR}/opaque_serdata.cpp)
set_target_properties(voxtouch_bus_opaque PROPERTIES UNITY_BUILD OFF)  # each file words its own refusals
add_library(voxtouch::bus_opaque ALIAS voxtouch_bus_opaque)
target_link_libraries(voxtouch_bus_opaque PUBLIC voxtouch::root CycloneDDS::ddsc PRIVATE fmt::fmt)
find_package(fmt REQUIRED)
