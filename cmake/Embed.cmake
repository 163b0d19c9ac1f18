# heartservo_embed(TARGET NAME FILE [NAME FILE]...): puts files into the program at build time, so that it needs none at
# run time. Makes "embedded.hpp" with `std::string_view heartservo::embedded::NAME()`; a changed file is built in anew.
# The assembler reads the file (.incbin): no generated array of a hundred thousand numbers to compile.
function(heartservo_embed target)
  set(header "#pragma once\n#include <string_view>\n\nnamespace heartservo::embedded {\n")
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  list(LENGTH ARGN count)
  math(EXPR last "${count} - 1")
  foreach(i RANGE 0 ${last} 2)
    math(EXPR j "${i} + 1")
    list(GET ARGN ${i} name)
    list(GET ARGN ${j} file)
    get_filename_component(file ${file} REALPATH BASE_DIR ${CMAKE_CURRENT_SOURCE_DIR})
    string(APPEND header "std::string_view ${name}();\n")
    file(CONFIGURE OUTPUT ${folder}/${name}.cpp @ONLY CONTENT [[#include "embedded.hpp"

asm(".pushsection .rodata\n"
    "embedded_@name@_begin: .incbin \"@file@\"\n"
    "embedded_@name@_end: .byte 0\n"
    ".popsection\n");
extern "C" const char embedded_@name@_begin[], embedded_@name@_end[];

std::string_view heartservo::embedded::@name@() {
  return {embedded_@name@_begin, static_cast<std::size_t>(embedded_@name@_end - embedded_@name@_begin)};
}
]])
    set_source_files_properties(${folder}/${name}.cpp PROPERTIES OBJECT_DEPENDS ${file} SKIP_PRECOMPILE_HEADERS ON)
    target_sources(${target} PRIVATE ${folder}/${name}.cpp)
  endforeach()
  file(CONFIGURE OUTPUT ${folder}/embedded.hpp @ONLY CONTENT "${header}}  // namespace heartservo::embedded\n")
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
