# The host: headers of one MeshLab version and the library of the same version, never mixed.
#   MESHLAB_SOURCE_DIR      folder with src/common and src/vcglib
#   DEVSEG_MESHLAB_VERSION  version of these headers, e.g. 2025.07
#   DEVSEG_PYMESHLAB_DIR    the installed pymeshlab package (double precision)
set(MESHLAB_SOURCE_DIR "" CACHE PATH "MeshLab source tree (src/common, src/vcglib)")
set(DEVSEG_MESHLAB_VERSION "2025.07" CACHE STRING "version of the MeshLab headers")
set(DEVSEG_PYMESHLAB_DIR "" CACHE PATH "installed pymeshlab package")

foreach(part src/common src/vcglib)
    if(NOT IS_DIRECTORY "${MESHLAB_SOURCE_DIR}/${part}")
        message(FATAL_ERROR "MESHLAB_SOURCE_DIR='${MESHLAB_SOURCE_DIR}' has no ${part}: "
            "give the MeshLab ${DEVSEG_MESHLAB_VERSION} source tree, or run scripts/quickstart.sh")
    endif()
endforeach()
find_library(DEVSEG_MESHLAB_COMMON meshlab-common
    PATHS "${DEVSEG_PYMESHLAB_DIR}/lib" NO_DEFAULT_PATH REQUIRED)
find_package(Qt5 REQUIRED COMPONENTS Core Gui Widgets Xml OpenGL)

add_library(devseg_meshlab INTERFACE)
target_include_directories(devseg_meshlab SYSTEM INTERFACE
    "${MESHLAB_SOURCE_DIR}/src" "${MESHLAB_SOURCE_DIR}/src/vcglib")
# The wheels of pymeshlab are built in double precision, and say so with a trailing d.
target_compile_definitions(devseg_meshlab INTERFACE
    MESHLAB_VERSION=${DEVSEG_MESHLAB_VERSION}d MESHLAB_SCALAR=double)
target_link_libraries(devseg_meshlab INTERFACE
    "${DEVSEG_MESHLAB_COMMON}" Eigen3::Eigen Qt5::Core Qt5::Gui Qt5::Widgets Qt5::Xml Qt5::OpenGL)
# The library refers to other libraries of the wheel, which the host has loaded long before us.
target_link_options(devseg_meshlab INTERFACE -Wl,--allow-shlib-undefined)

# devseg_plugin(NAME SOURCES...): one MeshLab plugin, in <build>/plugins.
function(devseg_plugin name)
    add_library(${name} MODULE ${ARGN})
    devseg_target(${name})
    target_link_libraries(${name} PRIVATE devseg_meshlab)
    set_target_properties(${name} PROPERTIES
        AUTOMOC ON
        LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/plugins"
        # The host has loaded its libraries before it loads a plugin; a run path would only tie
        # the plugin to this machine.
        SKIP_BUILD_RPATH ON)
    # A module may have undefined symbols by default, and fails only when the host loads it.
    target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL -Wl,-z,defs)
    install(TARGETS ${name} LIBRARY DESTINATION .)
endfunction()
