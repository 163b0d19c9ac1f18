# Compiler options shared by every target, ccache, and the helper that makes one library per floor.

find_program(CCACHE ccache)
if(CCACHE)
  # Precompiled headers and ccache agree only with these settings (ccache manual, "Precompiled headers").
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${CCACHE})
endif()

add_library(heartservo_options INTERFACE)
target_compile_options(heartservo_options INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -fpch-preprocess
                       # a NaN test must stay a NaN test, but errno and traps are nobody's business here
                       -fno-math-errno -fno-trapping-math)
if(HEARTSERVO_SANITIZE)
  target_compile_options(heartservo_options INTERFACE -fsanitize=${HEARTSERVO_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all
                         # GCC 12 reports instrumented code of std::regex
                         -Wno-maybe-uninitialized)
  target_link_options(heartservo_options INTERFACE -fsanitize=${HEARTSERVO_SANITIZE})
  target_compile_definitions(heartservo_options INTERFACE HEARTSERVO_SANITIZED)
endif()

# heartservo_visp_sources(SOURCES...): ViSP 3.5's headers are not C++20 (vpArray2D.h names its constructors
# vpArray2D<Type>), so a source that includes them itself is compiled as C++17; a header that other sources include must
# not include them.
function(heartservo_visp_sources)
  foreach(source IN LISTS ARGN)
    file(STRINGS ${source} includes REGEX "^#include <visp3/" LIMIT_COUNT 1)
    if(includes)
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS -std=c++17 SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()

# heartservo_floor(NAME LIBRARIES...): the library heartservo::NAME from every source of the current folder.
function(heartservo_floor name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  heartservo_visp_sources(${sources})
  add_library(heartservo_${name} STATIC ${sources})
  add_library(heartservo::${name} ALIAS heartservo_${name})
  set_target_properties(heartservo_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(heartservo_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                             $<INSTALL_INTERFACE:include/heartservo>)
  target_link_libraries(heartservo_${name} PUBLIC ${ARGN} PRIVATE $<BUILD_INTERFACE:heartservo_options>)
  target_precompile_headers(heartservo_${name} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/precompiled.hpp)
endfunction()
