# INTERFACE targets: warnings and options for bit-identical results, which every library links; and
# options for a fast compilation.
find_package(Threads REQUIRED)

add_library(voxtouch_warnings INTERFACE)
add_library(voxtouch::warnings ALIAS voxtouch_warnings)
target_compile_options(voxtouch_warnings INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wconversion
  -Wno-sign-conversion>
  $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<BOOL:${VOXTOUCH_WERROR}>>:-Werror>)

# No contraction into fused multiply-adds: the same source gives bit-identical results for any
# compiler.
add_library(voxtouch_reproducible INTERFACE)
add_library(voxtouch::reproducible ALIAS voxtouch_reproducible)
target_compile_options(voxtouch_reproducible INTERFACE -ffp-contract=off -fno-fast-math)

# Code outside the loop's arithmetic: tests, command lines, nodes, readers of files, the reference,
# simulated controllers. It is most of the code, and its time is spent in libraries. Results do not
# depend on the option. Programs that measure times or count instructions do not link it. GCC's
# warning about uninitialised variables is not an error: at -O1 it sees fewer paths.
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

# By default GCC frees memory while it compiles, for small machines. Units of eight files rarely
# need more than this: a tenth less time.
add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=524288>)  # [KiB]

# The repository's root is the only include root: #include "core/voxmap/voxmap.hpp" names the path.
add_library(voxtouch_root INTERFACE)
add_library(voxtouch::root ALIAS voxtouch_root)
target_include_directories(voxtouch_root
  INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/voxtouch>)
target_link_libraries(voxtouch_root
  INTERFACE $<BUILD_INTERFACE:voxtouch::warnings> voxtouch::reproducible Threads::Threads)
