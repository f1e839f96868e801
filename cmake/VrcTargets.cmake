# SPDX-License-Identifier: GPL-3.0-or-later

# Flags of every target of ours. GCC 12 misreads Eigen's vectorised fixed-size vectors as uninitialised
# or overrun, and string concatenation as overlapping; those three warnings are off.
add_library(vrc_flags INTERFACE)
target_compile_options(vrc_flags INTERFACE
  -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wunused -Woverloaded-virtual
  -Wconversion -Wno-sign-conversion -Wno-psabi -Wno-maybe-uninitialized -Wno-array-bounds -Wno-restrict
  -fno-math-errno -fno-trapping-math)
if(VRC_WERROR)
  target_compile_options(vrc_flags INTERFACE -Werror)
endif()
if(VRC_NATIVE)
  target_compile_options(vrc_flags INTERFACE -march=native)
endif()

# vrc_library(NAME PUBLIC libs... PRIVATE libs...)
# A layer: sources in NAME/src, include root NAME/include. A source sees only the include roots of
# the libraries it links, so an upward include does not compile.
function(vrc_library name)
  cmake_parse_arguments(ARG "" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp)
  add_library(vrc_${name} STATIC ${sources})
  target_include_directories(vrc_${name} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/include
                                         PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(vrc_${name} PUBLIC ${ARG_PUBLIC} PRIVATE vrc_flags ${ARG_PRIVATE})
endfunction()

# vrc_embed_text(NAME header function files...)
# The text of the files, one after the other, as `std::string_view function()`, which `header` of the layer
# NAME declares.
function(vrc_embed_text name header function)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE inputs)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  set(script ${CMAKE_SOURCE_DIR}/cmake/EmbedText.cmake)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} "-DINPUTS=${inputs}" -DOUTPUT=${output} -DHEADER=${header}
            -DFUNCTION=${function} -P ${script}
    DEPENDS ${inputs} ${script} VERBATIM)
  target_sources(vrc_${name} PRIVATE ${output})
endfunction()
