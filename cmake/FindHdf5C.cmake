# Finds HDF5's C library as the target Hdf5C::Hdf5C. CMake's own module needs a C compiler and HDF5's compiler wrapper,
# which a cross-compiled C++ project does not have.
include(FindPackageHandleStandardArgs)

find_path(HDF5C_INCLUDE_DIR hdf5.h PATH_SUFFIXES hdf5/serial)  # Debian has several builds in parallel
find_library(HDF5C_LIBRARY NAMES hdf5_serial hdf5)
mark_as_advanced(HDF5C_INCLUDE_DIR HDF5C_LIBRARY)
find_package_handle_standard_args(Hdf5C REQUIRED_VARS HDF5C_LIBRARY HDF5C_INCLUDE_DIR)

if(Hdf5C_FOUND AND NOT TARGET Hdf5C::Hdf5C)
  add_library(Hdf5C::Hdf5C UNKNOWN IMPORTED)
  set_target_properties(Hdf5C::Hdf5C PROPERTIES IMPORTED_LOCATION ${HDF5C_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${HDF5C_INCLUDE_DIR})
  if(HDF5C_LIBRARY MATCHES "\\.a$")  # scripts/wheel links a static one
    set_target_properties(Hdf5C::Hdf5C PROPERTIES INTERFACE_LINK_LIBRARIES "ZLIB::ZLIB;Threads::Threads;${CMAKE_DL_LIBS}")
  endif()
endif()
