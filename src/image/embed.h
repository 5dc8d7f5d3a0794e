/* A file made part of the object: PM__EMBED(name, "path") at file scope defines the bytes from name to name_end. The
 * path is relative to where the compiler runs; the Makefile must know that the object depends on the file. */
#ifndef PM_IMAGE_EMBED_H
#define PM_IMAGE_EMBED_H

/* A byte follows, so that no two names are one place even where the file is empty. */
#define PM__EMBED(name, path)                                                                        \
    extern const unsigned char name[], name##_end[];                                                 \
    __asm__(".pushsection .rodata\n.balign 16\n.globl " #name "\n.globl " #name "_end\n" #name ":\n" \
            ".incbin \"" path "\"\n" #name "_end:\n.byte 0\n.popsection\n")

#endif
