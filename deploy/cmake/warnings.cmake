# INTERFACE targets: what the compiler warns of and what keeps bits equal, which every library of the project links; and what is compiled
# quickly instead of to run quickly.
find_package(Threads REQUIRED)

add_library(voxtouch_warnings INTERFACE)
add_library(voxtouch::warnings ALIAS voxtouch_warnings)
target_compile_options(voxtouch_warnings INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wconversion -Wno-sign-conversion>
  $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<BOOL:${VOXTOUCH_WERROR}>>:-Werror>)

# No contraction into fused multiply-adds: the same source gives the same bits whatever the compiler finds to fuse.
add_library(voxtouch_reproducible INTERFACE)
add_library(voxtouch::reproducible ALIAS voxtouch_reproducible)
target_compile_options(voxtouch_reproducible INTERFACE -ffp-contract=off -fno-fast-math)

# Code outside the loop's arithmetic: tests, command lines, nodes, readers of files, the reference, simulated controllers. It calls the
# libraries for whatever takes time and is most of what is compiled. Results do not depend on it. Programs that measure times or count
# instructions do not link it. GCC's suspicion that a variable is read uninitialised stays a warning: at -O1 it sees fewer paths.
add_library(voxtouch_runs_once INTERFACE)
add_library(voxtouch::runs_once ALIAS voxtouch_runs_once)
target_compile_options(voxtouch_runs_once INTERFACE
  "$<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:-O1;-Wno-error=maybe-uninitialized>")

# voxtouch_runs_once(<targets>): compiles these libraries so.
function(voxtouch_runs_once)
  foreach(target IN LISTS ARGN)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:voxtouch::runs_once>)
  endforeach()
endfunction()

# GCC frees memory while it compiles as if there were little of it. Units of eight files rarely need more than this: a tenth less time.
add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=524288>)  # [KiB]

# The repository's root is the one include root: #include "core/voxmap/voxmap.hpp" says where the file is.
add_library(voxtouch_root INTERFACE)
add_library(voxtouch::root ALIAS voxtouch_root)
target_include_directories(voxtouch_root INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/voxtouch>)
target_link_libraries(voxtouch_root INTERFACE $<BUILD_INTERFACE:voxtouch::warnings> voxtouch::reproducible Threads::Threads)
