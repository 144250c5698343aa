# A library of the project for other programs, as odoless::NAME: by add_subdirectory, or installed, by
# find_package(odoless COMPONENTS NAME). Headers are included as here, "NAME/...".
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

function(odoless_library name)
  set(target odoless_${name})
  add_library(odoless::${name} ALIAS ${target})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                 $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/odoless>)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  if(PROJECT_IS_TOP_LEVEL)
    if(EXISTS ${PROJECT_SOURCE_DIR}/${name})  # its headers; the library for C has one of its own
      install(DIRECTORY ${PROJECT_SOURCE_DIR}/${name} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/odoless COMPONENT dev
              FILES_MATCHING PATTERN *.hpp)
    endif()
    install(TARGETS ${target} EXPORT odoless-${name} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
    install(EXPORT odoless-${name} NAMESPACE odoless:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/odoless COMPONENT dev)
  endif()
endfunction()
