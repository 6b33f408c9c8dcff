/* The fonts, as they are. */
    .section .rodata
    .global devseg_font
    .hidden devseg_font
    .global devseg_font_end
    .hidden devseg_font_end
devseg_font:
    .incbin DEVSEG_FONT
devseg_font_end:
    .byte 0

    .global devseg_far_font
    .hidden devseg_far_font
    .global devseg_far_font_end
    .hidden devseg_far_font_end
devseg_far_font:
    .incbin DEVSEG_FAR_FONT
devseg_far_font_end:
    .byte 0

    .section .note.GNU-stack, "", %progbits
