# Turns PLIANT_CUDA into pliant_has_cuda. A project that adds Pliant as a folder enables CUDA as a
# language itself, if it wants to; only Pliant's own programs enable it here.
set(pliant_has_cuda OFF)

if(NOT PLIANT_CUDA)
  return()
endif()

if(NOT PROJECT_IS_TOP_LEVEL)
  find_package(CUDAToolkit QUIET)
  set(pliant_has_cuda ${CUDAToolkit_FOUND})
  return()
endif()

include(CheckLanguage)
check_language(CUDA)
if(CMAKE_CUDA_COMPILER)
  # Code for the GPUs of this machine; for the H100 and H200 where there is none.
  if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES AND NOT DEFINED ENV{CUDAARCHS})
    execute_process(COMMAND nvidia-smi --query-gpu=compute_cap --format=csv,noheader
                    OUTPUT_VARIABLE architectures ERROR_QUIET)
    string(REGEX MATCHALL "[0-9]+\\.[0-9]+" architectures "${architectures}")
    list(REMOVE_DUPLICATES architectures)
    list(TRANSFORM architectures REPLACE "\\." "")
    if(NOT architectures)
      set(architectures 90)
    endif()
    set(CMAKE_CUDA_ARCHITECTURES "${architectures}" CACHE STRING "GPU architectures to compile for")
  endif()
  enable_language(CUDA)
  find_package(CUDAToolkit REQUIRED)
  set(pliant_has_cuda ON)
  message(STATUS "CUDA ${CUDAToolkit_VERSION} for GPU architectures ${CMAKE_CUDA_ARCHITECTURES}")
elseif(PLIANT_CUDA STREQUAL AUTO)
  message(STATUS "nvcc was not found, so pliant::cuda, its tests, examples and benchmarks are left "
                 "out. To have them, install the CUDA toolkit, put nvcc on the PATH or pass "
                 "-DCMAKE_CUDA_COMPILER=<nvcc>.")
else()
  message(FATAL_ERROR "PLIANT_CUDA is ${PLIANT_CUDA}, but nvcc was not found. Install the CUDA "
                      "toolkit, put nvcc on the PATH or pass -DCMAKE_CUDA_COMPILER=<nvcc>.")
endif()
