# pellicle_library(NAME FOLDER dir SOURCES ... PUBLIC deps... PRIVATE deps...)
#
# One static library per folder. Headers are included as "pellicle/<folder>/<header>.h": the build tree holds one
# link per folder, so that sources and an installed copy spell an include alike. A pellicle:: dependency that is
# not defined yet is an error, which is what keeps the folders free of cycles. Headers in a folder `internal` are for
# that folder's own sources and are not installed.
add_library(pellicle_warnings INTERFACE)
target_compile_options(pellicle_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                       -Woverloaded-virtual -Wcast-align $<$<BOOL:${PELLICLE_WERROR}>:-Werror>)
# What the sanitizers look at: the libraries and the program. The tests' own sources only link against them, which takes half the time to
# compile.
add_library(pellicle_sanitizers INTERFACE)
if(PELLICLE_SANITIZE)
  # Without the checks of every single access (null, alignment, object size), a third of the time: the address sanitizer stops at a bad
  # access anyway.
  target_compile_options(pellicle_sanitizers INTERFACE -fsanitize=address,undefined -fno-sanitize=null,alignment,object-size
                         -fno-sanitize-recover=undefined -fno-omit-frame-pointer -g1)
  target_link_options(pellicle_sanitizers INTERFACE -fsanitize=address,undefined)
  # Eigen would take another allocator here than in the libraries (Ceres) that were built without the sanitizer.
  target_compile_definitions(pellicle_warnings INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

if(CMAKE_UNITY_BUILD)  # several sources as one: half the time of a build from nothing
  target_compile_options(pellicle_warnings INTERFACE -Wno-subobject-linkage)
endif()

set(PELLICLE_INCLUDE_LINKS ${CMAKE_BINARY_DIR}/include CACHE INTERNAL "")
file(MAKE_DIRECTORY ${PELLICLE_INCLUDE_LINKS}/pellicle)

function(pellicle_library name)
  cmake_parse_arguments(ARG "" "FOLDER" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  foreach(dep IN LISTS ARG_PUBLIC ARG_PRIVATE)
    if(dep MATCHES "^pellicle::" AND NOT TARGET ${dep})
      message(FATAL_ERROR "${name} uses ${dep}, which lies above it: dependencies run downward only")
    endif()
  endforeach()
  set(target pellicle_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(pellicle::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${PELLICLE_INCLUDE_LINKS}/pellicle/${ARG_FOLDER} SYMBOLIC)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PELLICLE_INCLUDE_LINKS}>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:pellicle_warnings>
                        $<BUILD_INTERFACE:pellicle_sanitizers>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_property(GLOBAL APPEND PROPERTY PELLICLE_LIBRARIES ${target})
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pellicle/${ARG_FOLDER}
          COMPONENT development FILES_MATCHING PATTERN "*.h" PATTERN "internal" EXCLUDE)
endfunction()
