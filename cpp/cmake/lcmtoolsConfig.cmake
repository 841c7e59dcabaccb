# The target lcmtools::lcmtools: the headers of nodes in C++, and liblcm. liblcm is the system's, which
# pkg-config knows, else the one that the Python package lcm brings.
#
#     find_package(lcmtools REQUIRED)
#     add_executable(listener listener.cpp)
#     target_link_libraries(listener PRIVATE lcmtools::lcmtools)
#     lcmtools_generate(listener std_msgs geometry_msgs/Twist acme FOLDERS ../types)
include(CMakeFindDependencyMacro)
find_dependency(Threads)

find_program(LCMTOOLS_PROGRAM lcmtools DOC "the command lcmtools")

if(NOT TARGET lcmtools::lcmtools)
  add_library(lcmtools::lcmtools INTERFACE IMPORTED)
  set_target_properties(lcmtools::lcmtools PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${CMAKE_CURRENT_LIST_DIR}/..")
  target_compile_features(lcmtools::lcmtools INTERFACE cxx_std_17)
  target_link_libraries(lcmtools::lcmtools INTERFACE Threads::Threads)

  find_package(PkgConfig QUIET)
  if(PkgConfig_FOUND)
    pkg_check_modules(LCMTOOLS_LIBLCM QUIET IMPORTED_TARGET lcm)
  endif()
  if(LCMTOOLS_LIBLCM_FOUND)
    target_link_libraries(lcmtools::lcmtools INTERFACE PkgConfig::LCMTOOLS_LIBLCM)
  else()
    if(LCMTOOLS_PROGRAM)
      execute_process(COMMAND "${LCMTOOLS_PROGRAM}" pkg cpp-path --lcm
        OUTPUT_VARIABLE _lcmtools_wheel OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    endif()
    find_path(LCM_INCLUDE_DIR lcm/lcm.h HINTS "${_lcmtools_wheel}/include")
    find_library(LCM_LIBRARY lcm HINTS "${_lcmtools_wheel}/lib")
    if(NOT LCM_INCLUDE_DIR OR NOT LCM_LIBRARY)
      set(lcmtools_FOUND FALSE)
      set(lcmtools_NOT_FOUND_MESSAGE
        "there is no liblcm; type: sudo apt install liblcm-dev, or pip install lcm")
      return()
    endif()
    target_include_directories(lcmtools::lcmtools INTERFACE "${LCM_INCLUDE_DIR}")
    target_link_libraries(lcmtools::lcmtools INTERFACE "${LCM_LIBRARY}")
  endif()
endif()

# lcmtools_generate(TARGET TYPE... [FOLDERS FOLDER...]) lets a target include the C++ code of types, which
# are named as for lcmtools msg generate: a package (std_msgs) or a type (geometry_msgs/Twist), also of
# one's own, whose files are in the folders msg and srv, in those of a Python package, or below FOLDERS.
# The code is made again when one of these files changes.
function(lcmtools_generate target)
  cmake_parse_arguments(PARSE_ARGV 1 of "" "" FOLDERS)
  if(NOT LCMTOOLS_PROGRAM)
    message(FATAL_ERROR "lcmtools_generate: there is no lcmtools on the PATH; -DLCMTOOLS_PROGRAM=... names it")
  endif()
  set(places msg/* srv/* */msg/* */srv/*)
  list(TRANSFORM places PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
  file(GLOB watched CONFIGURE_DEPENDS ${places})
  set(path "$ENV{LCMTOOLS_TYPE_PATH}")
  foreach(name IN LISTS of_FOLDERS)
    get_filename_component(folder "${name}" ABSOLUTE)
    if(NOT IS_DIRECTORY "${folder}")
      message(FATAL_ERROR "lcmtools_generate(${target}): there is no folder ${folder}")
    endif()
    file(GLOB_RECURSE own CONFIGURE_DEPENDS
      "${folder}/*.lcm" "${folder}/*.msg" "${folder}/*.srv" "${folder}/*.action")
    list(APPEND watched ${own})
    string(PREPEND path "${folder}:")
  endforeach()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${watched})
  set(made "${CMAKE_CURRENT_BINARY_DIR}/${target}_types")
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -E env "LCMTOOLS_TYPE_PATH=${path}"
      "${LCMTOOLS_PROGRAM}" msg generate --lang cpp "${made}" ${of_UNPARSED_ARGUMENTS}
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
    OUTPUT_QUIET ERROR_VARIABLE error RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "  ${error}")  # the spaces keep its lines whole
  endif()
  target_include_directories(${target} PRIVATE "${made}")
endfunction()
