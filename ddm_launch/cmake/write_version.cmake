# Writes version.h with the version of the package and, in a git checkout, of the commit. The file is touched only
# when the version changes, so that a build without changes stays one.

# git refuses a checkout of another user, as in a container, unless the settings in the home folder allow it. Older versions
# ignore `-c safe.directory`. Nothing is written into the checkout.
file(WRITE ${OUT}.home/.gitconfig "[safe]\n\tdirectory = *\n")
execute_process(COMMAND ${CMAKE_COMMAND} -E env HOME=${OUT}.home GIT_OPTIONAL_LOCKS=0
                        git -C ${SOURCE} describe --always --dirty
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
file(REMOVE_RECURSE ${OUT}.home)

# A Docker image has no git, and of .git only what names the commit: see .dockerignore.
if(failed)
  get_filename_component(git ${SOURCE}/../.git ABSOLUTE)
  set(commit "")
  if(EXISTS ${git}/HEAD)
    file(STRINGS ${git}/HEAD commit LIMIT_COUNT 1)
  endif()
  if(commit MATCHES "^ref: (.+)$")
    set(ref ${CMAKE_MATCH_1})
    set(commit "")
    if(EXISTS ${git}/${ref})
      file(STRINGS ${git}/${ref} commit LIMIT_COUNT 1)
    elseif(EXISTS ${git}/packed-refs)
      file(STRINGS ${git}/packed-refs lines)
      foreach(line IN LISTS lines)
        if(line MATCHES " ${ref}$")
          set(commit ${line})
        endif()
      endforeach()
    endif()
  endif()
  if(commit MATCHES "^[0-9a-f]+")
    string(SUBSTRING ${commit} 0 7 commit)
    set(commit "${commit}, changes unknown")
  else()
    set(commit "unknown commit")
  endif()
endif()

file(WRITE ${OUT}.new "#define DDM_CODE_VERSION \"${PACKAGE_VERSION} (${commit})\"\n")
execute_process(COMMAND ${CMAKE_COMMAND} -E copy_if_different ${OUT}.new ${OUT})
file(REMOVE ${OUT}.new)
