# Parsing the headers of others is half of a compile. It happens once for each set of flags: the empty libraries here hold the
# precompiled headers, all other targets reuse them. Headers of our own stay out, because g++ does not warn about what stands
# in a precompiled header.
#
# lab_precompiled(FOR target..): FOR is library (full optimisation), program (what only people wait for: -O1) or test.

# ccache needs -fpch-preprocess to see what a precompiled header was made from. clang (preset fuzz) goes without them.
# -Wno-stringop-overflow: the same false warnings as -Wno-restrict (GCC bug 105651); g++ 12 hides them in system headers only
# as long as these are not precompiled.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess> -Wno-stringop-overflow)
  # g++ collects its garbage less often: a tenth faster, for a sixth more memory
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-expand=300> $<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=524288>)
else()
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
endif()

find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
set(COMMON_HEADERS <algorithm> <cmath> <functional> <map> <memory> <optional> <span> <stdexcept> <string> <vector>
                   <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <nlohmann/json.hpp>)
set(TEST_HEADERS <gtest/gtest.h>)
# -fPIC: programs would be compiled with -fPIE, and could not share with libraries
set(PROGRAM_FLAGS $<$<CONFIG:Release>:-O1> -fPIC)
set(TEST_FLAGS ${PROGRAM_FLAGS})
# g++ refuses a precompiled header when a macro that occurs in it is defined differently: GTEST_HAS_PTHREAD, FMT_SHARED
set(TEST_LIBS GTest::gtest)
add_compile_definitions(FMT_SHARED)

file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/empty.cc CONTENT "")
set(kinds LIBRARY PROGRAM)
if(LAB_TESTS)
  list(APPEND kinds TEST)
endif()
foreach(kind ${kinds})
  string(TOLOWER ${kind}_headers name)
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/empty.cc)
  target_link_libraries(${name} PRIVATE Eigen3::Eigen nlohmann_json::nlohmann_json ${${kind}_LIBS})
  target_compile_options(${name} PRIVATE ${${kind}_FLAGS})
  target_precompile_headers(${name} PRIVATE ${COMMON_HEADERS} ${${kind}_HEADERS})
endforeach()

function(lab_precompiled FOR)
  string(TOUPPER ${FOR} kind)
  foreach(target ${ARGN})
    target_compile_options(${target} PRIVATE ${${kind}_FLAGS})
    target_precompile_headers(${target} REUSE_FROM ${FOR}_headers)
  endforeach()
endfunction()
