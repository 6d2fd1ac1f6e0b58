# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DOUTPUT=… -DWEB=<this folder> -DTHREE=three.min.js -DSCRIPTS=a.js,b.js -P embed.cmake
# Writes the front end of report.html as C++ raw strings.
function(embed name)
  set(text "")
  foreach(file ${ARGN})
    file(READ ${file} part)
    string(APPEND text "${part}")
  endforeach()
  # A script element ends at the first "</script", wherever it stands.
  string(REPLACE "</script" "<\\/script" text "${text}")
  file(APPEND ${OUTPUT}.new "const std::string_view ${name} = R\"millpose(${text})millpose\";\n")
endfunction()

file(WRITE ${OUTPUT}.new "// Made by web/embed.cmake.\n#include \"report/web_assets.hpp\"\n\nnamespace millpose {\n")
file(READ ${WEB}/page.html page)
file(APPEND ${OUTPUT}.new "const std::string_view kWebPage = R\"millpose(${page})millpose\";\n")
embed(kWebStyle ${WEB}/style.css)
embed(kWebLicense ${WEB}/three-license.txt)
embed(kWebThree ${THREE})
string(REPLACE "," ";" SCRIPTS "${SCRIPTS}")
list(TRANSFORM SCRIPTS PREPEND ${WEB}/)
embed(kWebScripts ${SCRIPTS})
file(APPEND ${OUTPUT}.new "}  // namespace millpose\n")
file(RENAME ${OUTPUT}.new ${OUTPUT})
