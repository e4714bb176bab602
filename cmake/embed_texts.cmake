# SPDX-License-Identifier: BSD-3-Clause
# posefusion_embed_texts(VARIABLE NAME|NAME_WE FILES...): entries of a map from the names of files, without
# their extension where it is NAME_WE, to their texts, as C++. CMake runs again when one of them changes.
function(posefusion_embed_texts variable how)
  set(entries "")
  foreach(file ${ARGN})
    get_filename_component(name ${file} ${how})
    file(READ ${file} text)
    string(APPEND entries "      {\"${name}\", R\"text(${text})text\"},\n")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  endforeach()
  set(${variable} "${entries}" PARENT_SCOPE)
endfunction()
