/* Files that are parts of the library, as they are. */
    .section .rodata

    .macro resource name, path
    .global devseg_\name
    .hidden devseg_\name
    .global devseg_\name\()_end
    .hidden devseg_\name\()_end
devseg_\name:
    .incbin "\path"
devseg_\name\()_end:
    .byte 0
    .endm

    resource page_html, "page.html"
    resource page_css, "page.css"
    resource page_js, "page.js"
    resource page_three, "three/three.min.js"
    resource page_three_license, "three/LICENSE"

    .section .note.GNU-stack, "", %progbits
