# The headers that most units read, parsed once: Eigen and the standard library for all, GoogleTest
# and fmt for the tests. It saves about a second of each unit, a third of the whole. OFF shows
# includes that a unit forgot. CLI11 gains nothing: its cost is code, not parsing.
option(VOXTOUCH_PRECOMPILED_HEADERS "Parse the headers that most units read once" ON)

set(VOXTOUCH_COMMON_HEADERS <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint>
  <functional> <limits> <memory>
  <optional> <span> <stdexcept> <string> <string_view> <vector>)
# Read by most units outside the loop. nlohmann/json takes 0.7 s of each unit that reads it, chrono
# 0.2 s, the others 0.1 s.
set(VOXTOUCH_OTHER_HEADERS <nlohmann/json.hpp> <fmt/format.h> <atomic> <chrono> <deque> <filesystem>
  <fstream> <map> <mutex> <random>
  <set> <thread> <unordered_map>)

# Every target of `type` in `folder` and below uses the headers that `donor` has precompiled. Only
# targets that link `library` take part: a header is precompiled with that library's definitions.
# Targets of voxtouch::runs_once use those of `donor`_runs_once, if it exists: GCC 14 refuses
# headers precompiled with other optimisation.
function(voxtouch_precompile_below folder type library donor)
  get_directory_property(folders DIRECTORY ${folder} SUBDIRECTORIES)
  foreach(below IN LISTS folders)
    voxtouch_precompile_below(${below} ${type} ${library} ${donor})
  endforeach()
  get_directory_property(targets DIRECTORY ${folder} BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(kind ${target} TYPE)
    get_target_property(own ${target} PRECOMPILE_HEADERS)
    get_target_property(libraries ${target} LINK_LIBRARIES)
    get_target_property(sources ${target} SOURCES)
    if(sources MATCHES "\\.c(;|$)")
      continue()  # a target that is C as well has no precompiled header for that half
    endif()
    if(kind STREQUAL type AND NOT own AND NOT target STREQUAL donor AND libraries MATCHES
      "${library}")
      if(libraries MATCHES "voxtouch::runs_once" AND TARGET ${donor}_runs_once)
        target_precompile_headers(${target} REUSE_FROM ${donor}_runs_once)
        # A precompiled header is taken only with the definitions and folders that it was compiled
        # with.
        target_compile_definitions(${target}
          PRIVATE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
        target_include_directories(${target} SYSTEM
          PRIVATE $<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>)
      else()
        target_precompile_headers(${target} REUSE_FROM ${donor})
      endif()
    endif()
  endforeach()
endfunction()

# A target that has only precompiled headers, for others to reuse.
function(voxtouch_headers donor kind)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${donor}.cpp CONTENT "int main() { return 0; }\n")
  if(kind STREQUAL EXECUTABLE)
    add_executable(${donor} ${CMAKE_BINARY_DIR}/${donor}.cpp)
  else()
    add_library(${donor} STATIC ${CMAKE_BINARY_DIR}/${donor}.cpp)
  endif()
  target_link_libraries(${donor} PRIVATE voxtouch::root Eigen3::Eigen ${ARGN})
  target_precompile_headers(${donor} PRIVATE ${VOXTOUCH_COMMON_HEADERS})
endfunction()

function(voxtouch_precompile)
  # GCC 12 treats a precompiled standard library as own code, and gives false warnings about its
  # string functions.
  target_compile_options(voxtouch_warnings INTERFACE
    $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CXX_COMPILER_ID:GNU>>:-Wno-restrict -Wno-stringop-overflow
    -Wno-stringop-overread -Wno-array-bounds>)
  voxtouch_headers(voxtouch_headers STATIC)
  voxtouch_headers(voxtouch_headers_runs_once STATIC voxtouch::runs_once fmt::fmt
    nlohmann_json::nlohmann_json)
  target_precompile_headers(voxtouch_headers_runs_once PRIVATE ${VOXTOUCH_OTHER_HEADERS})
  foreach(folder core devices nodes)
    voxtouch_precompile_below(${PROJECT_SOURCE_DIR}/${folder} STATIC_LIBRARY voxtouch::
      voxtouch_headers)
  endforeach()
  if(VOXTOUCH_TESTS)
    voxtouch_headers(voxtouch_test_headers EXECUTABLE fmt::fmt nlohmann_json::nlohmann_json
      GTest::gtest voxtouch::runs_once)
    target_precompile_headers(voxtouch_test_headers
      PRIVATE <gtest/gtest.h> ${VOXTOUCH_OTHER_HEADERS})
    voxtouch_precompile_below(${PROJECT_SOURCE_DIR}/tests STATIC_LIBRARY voxtouch::runs_once
      voxtouch_headers)
    voxtouch_precompile_below(${PROJECT_SOURCE_DIR}/tests EXECUTABLE GTest:: voxtouch_test_headers)
  endif()
endfunction()
