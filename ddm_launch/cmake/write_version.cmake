# Writes version.h with the version of the package and, in a git checkout, of the commit. The file is touched only
# when the version changes, so that a build without changes stays one.

execute_process(COMMAND git -C ${SOURCE} describe --always --dirty
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown commit")
endif()
file(WRITE ${OUT}.new "#define DDM_CODE_VERSION \"${PACKAGE_VERSION} (${commit})\"\n")
execute_process(COMMAND ${CMAKE_COMMAND} -E copy_if_different ${OUT}.new ${OUT})
file(REMOVE ${OUT}.new)
