# Files of clingo that do not go together with others in one. They are named when all targets are known.
cmake_language(DEFER CALL set_property SOURCE libgringo/src/input/literals.cc TARGET_DIRECTORY libgringo
    PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
cmake_language(DEFER CALL set_property TARGET libclingo PROPERTY UNITY_BUILD OFF)

# GCC frees memory less often while it compiles, which takes less time. The code is the same.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(--param=ggc-min-expand=400 --param=ggc-min-heapsize=500000)
endif()
