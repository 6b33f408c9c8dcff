/* The font, as it is. */
    .section .rodata
    .global devseg_font
    .hidden devseg_font
    .global devseg_font_end
    .hidden devseg_font_end
devseg_font:
    .incbin DEVSEG_FONT
devseg_font_end:
    .byte 0

    .section .note.GNU-stack, "", %progbits
