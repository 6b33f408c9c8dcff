# The host: headers of one MeshLab version and the library of the same version, never mixed.
#   DEVSEG_FLAVOUR          HOST-VERSION: pymeshlab-2025.07, meshlab-2020.09, ...
#   MESHLAB_SOURCE_DIR      folder with src/common and vcglib (in src, or beside it as in 2020.09)
#   DEVSEG_PYMESHLAB_DIR    for pymeshlab flavours: the installed pymeshlab package
#   DEVSEG_MESHLAB_LIB_DIR  for meshlab flavours: folder of libmeshlab-common; without it the
#                           plugins are built all the same, but their symbols are not checked
set(DEVSEG_FLAVOUR "pymeshlab-2025.07" CACHE STRING "host that the plugins are built for")
set(MESHLAB_SOURCE_DIR "" CACHE PATH "MeshLab source tree (src/common, vcglib)")
set(DEVSEG_PYMESHLAB_DIR "" CACHE PATH "installed pymeshlab package")
set(DEVSEG_MESHLAB_LIB_DIR "" CACHE PATH "folder of libmeshlab-common")

if(NOT DEVSEG_FLAVOUR MATCHES "^(py)?meshlab-(2020\\.09|2022\\.02|2025\\.07)$"
        OR DEVSEG_FLAVOUR STREQUAL "pymeshlab-2020.09")
    message(FATAL_ERROR "DEVSEG_FLAVOUR='${DEVSEG_FLAVOUR}': expected pymeshlab-2025.07, "
        "pymeshlab-2022.02, meshlab-2025.07, meshlab-2022.02 or meshlab-2020.09")
endif()
set(meshlab_version "${CMAKE_MATCH_2}")
find_path(DEVSEG_VCG_INCLUDE vcg/complex/complex.h
    PATHS "${MESHLAB_SOURCE_DIR}/src/vcglib" "${MESHLAB_SOURCE_DIR}/vcglib" NO_DEFAULT_PATH)
if(NOT IS_DIRECTORY "${MESHLAB_SOURCE_DIR}/src/common" OR NOT DEVSEG_VCG_INCLUDE)
    message(FATAL_ERROR "MESHLAB_SOURCE_DIR='${MESHLAB_SOURCE_DIR}' has no src/common or no "
        "vcglib: give the MeshLab ${meshlab_version} source tree, or run "
        "scripts/build_host.sh ${DEVSEG_FLAVOUR}")
endif()

# The plugin interface changed once; the later versions of it are the same in source.
set(DEVSEG_MESHLAB_API meshlab2025)
if(meshlab_version STREQUAL "2020.09")
    set(DEVSEG_MESHLAB_API meshlab2020)
endif()
# The wheels of pymeshlab are built in double precision, and say so with a trailing d.
set(meshlab_scalar float)
set(meshlab_library_dir "${DEVSEG_MESHLAB_LIB_DIR}")
if(DEVSEG_FLAVOUR MATCHES "^pymeshlab")
    set(meshlab_scalar double)
    string(APPEND meshlab_version d)
    set(meshlab_library_dir "${DEVSEG_PYMESHLAB_DIR}/lib")
endif()
find_package(Qt5 REQUIRED COMPONENTS Core Gui Widgets Xml OpenGL)

add_library(devseg_meshlab INTERFACE)
target_include_directories(devseg_meshlab SYSTEM INTERFACE
    "${MESHLAB_SOURCE_DIR}/src" "${DEVSEG_VCG_INCLUDE}")
target_compile_definitions(devseg_meshlab INTERFACE
    MESHLAB_VERSION=${meshlab_version} MESHLAB_SCALAR=${meshlab_scalar})
target_link_libraries(devseg_meshlab INTERFACE
    Eigen3::Eigen Qt5::Core Qt5::Gui Qt5::Widgets Qt5::Xml Qt5::OpenGL)
if(meshlab_library_dir)
    find_library(DEVSEG_MESHLAB_COMMON meshlab-common
        PATHS "${meshlab_library_dir}" NO_DEFAULT_PATH REQUIRED)
    target_link_libraries(devseg_meshlab INTERFACE "${DEVSEG_MESHLAB_COMMON}")
    # A module may have undefined symbols by default, and fails only when the host loads it. The
    # library itself refers to others, which the host has loaded long before us.
    target_link_options(devseg_meshlab INTERFACE -Wl,-z,defs -Wl,--allow-shlib-undefined)
endif()

# devseg_plugin(NAME SOURCES...): one MeshLab plugin, in <build>/plugins.
function(devseg_plugin name)
    add_library(${name} MODULE ${ARGN})
    devseg_target(${name})
    target_link_libraries(${name} PRIVATE devseg_meshlab)
    # `devseg info` reads this from the file.
    target_compile_definitions(${name} PRIVATE DEVSEG_FLAVOUR="${DEVSEG_FLAVOUR}")
    set_target_properties(${name} PROPERTIES
        AUTOMOC ON
        LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/plugins"
        # The host has loaded its libraries before it loads a plugin; a run path would only tie
        # the plugin to this machine.
        SKIP_BUILD_RPATH ON)
    target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
    install(TARGETS ${name} LIBRARY DESTINATION .)
endfunction()
