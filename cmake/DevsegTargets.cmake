# devseg_target(NAME): the house's compile settings for one target of this project.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)

function(devseg_target name)
    target_compile_options(${name} PRIVATE
        -Wall -Wextra -Wshadow -Wpedantic -Wconversion -Werror)
    # Contraction into fused multiply-adds depends on the compiler's mood and the target CPU:
    # switched off, so that the same input gives the same bytes everywhere.
    target_compile_options(${name} PRIVATE -ffp-contract=off)
    if(DEVSEG_SANITIZE)
        # GCC's analysis sees uninitialised values inside std::regex once code is instrumented.
        target_compile_options(${name} PRIVATE
            -fsanitize=${DEVSEG_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
            -Wno-maybe-uninitialized)
        target_link_options(${name} PRIVATE -fsanitize=${DEVSEG_SANITIZE})
    endif()
    if(DEVSEG_FUZZ)
        # Clang warns of other things than the compiler that the house builds with.
        target_compile_options(${name} PRIVATE -fsanitize=fuzzer-no-link -Wno-error)
    endif()
endfunction()
