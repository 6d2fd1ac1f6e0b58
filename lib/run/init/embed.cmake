# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUTPUT=… -DCELLS=a.yaml,b.yaml -DFIRST=a -P embed.cmake
# Writes sample cells as C++ raw strings.
file(WRITE ${OUTPUT}.new "// Made by embed.cmake.\n#include \"run/init/sample_cells.hpp\"\n\nnamespace millpose {\n"
     "const std::vector<SampleCell>& SampleCells() {\n  static const std::vector<SampleCell> cells = {\n")
string(REPLACE "," ";" CELLS "${CELLS}")
string(REPLACE "," ";" FIRST "${FIRST}")
foreach(file ${CELLS})
  file(READ ${file} text)
  get_filename_component(name ${file} NAME_WE)
  set(is_first false)
  list(FIND FIRST ${name} at)
  if(NOT at EQUAL -1)
    set(is_first true)
  endif()
  file(APPEND ${OUTPUT}.new "      {\"${name}\", R\"millpose(${text})millpose\", ${is_first}},\n")
endforeach()
file(APPEND ${OUTPUT}.new "  };\n  return cells;\n}\n}  // namespace millpose\n")
file(RENAME ${OUTPUT}.new ${OUTPUT})
