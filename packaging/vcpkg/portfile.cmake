# The C library for vcpkg, from the clone around this file. cargo must be on the PATH.
#
#     vcpkg install jcas --overlay-ports=packaging/vcpkg
#
# Not tried: vcpkg has not read this file yet. `.ci/package.sh` tries the CMake project.
set(VCPKG_BUILD_TYPE release)
get_filename_component(clone "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
vcpkg_cmake_configure(SOURCE_PATH "${clone}")
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/jcas)
vcpkg_fixup_pkgconfig()
if(VCPKG_LIBRARY_LINKAGE STREQUAL "static")
    file(GLOB shared "${CURRENT_PACKAGES_DIR}/lib/libjcas.so*")
    file(REMOVE ${shared})
endif()
vcpkg_install_copyright(FILE_LIST "${clone}/LICENSE-MIT" "${clone}/LICENSE-APACHE")
