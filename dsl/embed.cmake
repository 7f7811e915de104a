# SPDX-License-Identifier: GPL-3.0-or-later
# Writes OUTPUT, a C++ source that holds the Lua files of the list MODULES as texts.
set(entries "")
foreach(path IN LISTS MODULES)
  get_filename_component(name ${path} NAME_WE)
  file(READ ${path} text)
  # The delimiter must not occur in a module; Lua has no use for it.
  if(text MATCHES "\\)TRELLIS_MODULE\"")
    message(FATAL_ERROR "${path} holds the delimiter of the generated source")
  endif()
  string(APPEND entries "    {\"${name}\", R\"TRELLIS_MODULE(${text})TRELLIS_MODULE\"},\n")
endforeach()
file(WRITE ${OUTPUT}.new "// SPDX-License-Identifier: GPL-3.0-or-later
// Generated from stdlib/*.lua.
#include <dsl/language/core/stdlib.hpp>

namespace trellis::dsl {

std::span<const Module> embedded_modules() {
  static constexpr Module modules[] = {
${entries}  };
  return modules;
}

}  // namespace trellis::dsl
")
file(RENAME ${OUTPUT}.new ${OUTPUT})
