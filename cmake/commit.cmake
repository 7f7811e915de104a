# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -D SOURCE=folder -D OUTPUT=file -P commit.cmake: writes a C++ source with the commit of the sources, and touches
# it only where that has changed.
set(commit "")
find_program(GIT git)
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT} -C ${SOURCE} -c safe.directory=* describe --always --dirty --abbrev=12 --exclude=*
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#include <dsl/command/provenance.hpp>

namespace trellis::command {

std::string commit() { return \"${commit}\"; }

}  // namespace trellis::command
")
