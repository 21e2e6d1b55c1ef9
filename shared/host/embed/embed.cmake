# cmake -DOUTPUT=page_files.cpp -DHEADER=PATH "-DFILES=a.js|b.css" -P embed.cmake
# Files as raw literals in one C++ source; page_file() of HEADER finds them by name.
string(REPLACE "|" ";" FILES "${FILES}")
set(delimiter embedded_file)
set(literals "")
set(choices "")
set(index 0)
foreach(file ${FILES})
  file(READ "${file}" text)
  if(text STREQUAL "" OR text MATCHES "\\)${delimiter}\"")
    message(FATAL_ERROR "${file}: is empty, or contains the end of a literal")
  endif()
  get_filename_component(name "${file}" NAME)
  string(APPEND literals "constexpr std::string_view kFile${index} = "
                         "R\"${delimiter}(${text})${delimiter}\";\n")
  string(APPEND choices "  if (name == \"${name}\") return kFile${index};\n")
  math(EXPR index "${index} + 1")
endforeach()
file(WRITE "${OUTPUT}.new" "// Made by shared/host/embed/embed.cmake.
#include \"${HEADER}\"

#include <stdexcept>
#include <string>

namespace bess {
namespace {

${literals}
}  // namespace

std::string_view page_file(std::string_view name) {
${choices}  throw std::logic_error(\"no file of the page is called \" + std::string(name));
}

}  // namespace bess
")
file(RENAME "${OUTPUT}.new" "${OUTPUT}")
