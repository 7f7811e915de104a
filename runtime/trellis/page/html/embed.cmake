# SPDX-License-Identifier: GPL-3.0-or-later
# Writes OUTPUT, a C++ source that holds the page's files in FOLDER as texts.
set(texts "")
foreach(part page=report.html style=report.css script=report.js charts=charts.js space=space.js teams=teams.js)
  string(REPLACE "=" ";" part ${part})
  list(GET part 0 field)
  list(GET part 1 file)
  file(READ ${FOLDER}/${file} text)
  if(text MATCHES "\\)TRELLIS_PAGE\"")
    message(FATAL_ERROR "${file} holds the delimiter of the generated source")
  endif()
  string(APPEND texts "      .${field} = R\"TRELLIS_PAGE(${text})TRELLIS_PAGE\",\n")
endforeach()
file(WRITE ${OUTPUT}.new "// SPDX-License-Identifier: GPL-3.0-or-later
// Generated from page/html.
#include <trellis/page/html_parts.hpp>

namespace trellis {

const HtmlParts& html_parts() {
  static constexpr HtmlParts parts = {
${texts}  };
  return parts;
}

}  // namespace trellis
")
file(RENAME ${OUTPUT}.new ${OUTPUT})
