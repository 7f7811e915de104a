# SPDX-License-Identifier: GPL-3.0-or-later
# Writes what `PROGRAM reference FORM` prints to OUTPUT.
execute_process(COMMAND ${PROGRAM} reference ${FORM} OUTPUT_FILE ${OUTPUT}.new COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${OUTPUT}.new ${OUTPUT})
