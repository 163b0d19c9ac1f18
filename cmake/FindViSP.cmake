# Debian's ViSP packages ship no CMake configuration outside libvisp-dev, and its pkg-config file links every module
# and 51 libraries; this finds just the modules asked for and makes the targets ViSP::core, ViSP::vs, ...
find_path(ViSP_INCLUDE_DIR visp3/core/vpConfig.h)
if(ViSP_INCLUDE_DIR)
  file(STRINGS ${ViSP_INCLUDE_DIR}/visp3/core/vpConfig.h _version REGEX "define VISP_VERSION_(MAJOR|MINOR|PATCH) ")
  string(REGEX REPLACE "[^0-9;]+" "" _version "${_version}")
  string(REPLACE ";" "." ViSP_VERSION "${_version}")
endif()
foreach(module IN LISTS ViSP_FIND_COMPONENTS)
  find_library(ViSP_${module}_LIBRARY visp_${module})
  if(ViSP_${module}_LIBRARY)
    set(ViSP_${module}_FOUND TRUE)
    if(NOT TARGET ViSP::${module})
      add_library(ViSP::${module} UNKNOWN IMPORTED)
      set_target_properties(ViSP::${module} PROPERTIES IMPORTED_LOCATION ${ViSP_${module}_LIBRARY}
                            INTERFACE_INCLUDE_DIRECTORIES ${ViSP_INCLUDE_DIR}
                            INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${ViSP_INCLUDE_DIR})
    endif()
  endif()
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ViSP REQUIRED_VARS ViSP_INCLUDE_DIR VERSION_VAR ViSP_VERSION HANDLE_COMPONENTS)
