# The package file of find_package(jcas), which defines these targets.
#
# - jcas::shared is the shared library, and jcas::static is the static library.
# - jcas::jcas is the static library, or the shared one if BUILD_SHARED_LIBS is on or only that is
#   installed.
#
# Paths are relative to this file, so that the installed tree can be moved.

get_filename_component(_jcas_prefix "${CMAKE_CURRENT_LIST_DIR}" ABSOLUTE)
while(NOT EXISTS "${_jcas_prefix}/include/jcas.h"
      AND NOT EXISTS "${_jcas_prefix}/include/jcas/jcas.h")
    get_filename_component(_jcas_parent "${_jcas_prefix}" DIRECTORY)
    if(_jcas_parent STREQUAL _jcas_prefix)
        set(jcas_FOUND FALSE)
        set(jcas_NOT_FOUND_MESSAGE
            "jcas.h lies in no include folder above ${CMAKE_CURRENT_LIST_DIR}")
        return()
    endif()
    set(_jcas_prefix "${_jcas_parent}")
endwhile()

set(_jcas_include "${_jcas_prefix}/include")
if(NOT EXISTS "${_jcas_include}/jcas.h")
    set(_jcas_include "${_jcas_prefix}/include/jcas")
endif()
file(GLOB _jcas_folders
    "${_jcas_prefix}/lib" "${_jcas_prefix}/lib64" "${_jcas_prefix}/lib/*-linux-*")

find_library(_jcas_shared NAMES libjcas.so libjcas.dylib jcas.dll.lib
    PATHS ${_jcas_folders} NO_DEFAULT_PATH NO_CACHE)
find_library(_jcas_static NAMES libjcas.a jcas.lib PATHS ${_jcas_folders} NO_DEFAULT_PATH NO_CACHE)
include(CMakeFindDependencyMacro)
find_dependency(Threads)

if(_jcas_shared AND NOT TARGET jcas::shared)
    add_library(jcas::shared SHARED IMPORTED)
    set_target_properties(jcas::shared PROPERTIES
        IMPORTED_LOCATION "${_jcas_shared}"
        INTERFACE_INCLUDE_DIRECTORIES "${_jcas_include}")
endif()
if(_jcas_static AND NOT TARGET jcas::static)
    add_library(jcas::static STATIC IMPORTED)
    set_target_properties(jcas::static PROPERTIES
        IMPORTED_LOCATION "${_jcas_static}"
        INTERFACE_INCLUDE_DIRECTORIES "${_jcas_include}"
        INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m")
endif()
if(NOT TARGET jcas::jcas)
    if(TARGET jcas::shared AND (BUILD_SHARED_LIBS OR NOT TARGET jcas::static))
        add_library(jcas::jcas INTERFACE IMPORTED)
        set_target_properties(jcas::jcas PROPERTIES INTERFACE_LINK_LIBRARIES jcas::shared)
    elseif(TARGET jcas::static)
        add_library(jcas::jcas INTERFACE IMPORTED)
        set_target_properties(jcas::jcas PROPERTIES INTERFACE_LINK_LIBRARIES jcas::static)
    else()
        set(jcas_FOUND FALSE)
        set(jcas_NOT_FOUND_MESSAGE "no libjcas in the library folders of ${_jcas_prefix}")
    endif()
endif()
