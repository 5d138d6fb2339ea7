# The C library for vcpkg, from the clone around this file. cargo must be on the PATH.
#
#     vcpkg install jcas --overlay-ports=packaging/vcpkg
#
# vcpkg's scripts of August 2026 have built the triplets x64-linux and x64-linux-dynamic, and a
# CMake project has used both. Not tried: the program vcpkg, which picks ports and checks packages.
set(VCPKG_BUILD_TYPE release)
get_filename_component(clone "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
vcpkg_cmake_configure(SOURCE_PATH "${clone}")
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/jcas)
vcpkg_fixup_pkgconfig()
if(VCPKG_LIBRARY_LINKAGE STREQUAL "static")
    file(GLOB shared "${CURRENT_PACKAGES_DIR}/lib/libjcas.so*")
    file(REMOVE ${shared})
else()
    file(REMOVE "${CURRENT_PACKAGES_DIR}/lib/libjcas.a")
endif()
vcpkg_install_copyright(FILE_LIST "${clone}/LICENSE-MIT" "${clone}/LICENSE-APACHE")
