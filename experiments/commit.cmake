# Writes what is being built into version.h; leaves the file alone when nothing changed.
execute_process(COMMAND git describe --always --dirty --abbrev=7 WORKING_DIRECTORY ${SOURCE_DIR}
  OUTPUT_VARIABLE GOTAI_COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
configure_file(${INPUT} ${OUTPUT} @ONLY)
