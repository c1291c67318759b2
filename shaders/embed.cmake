# cmake -DMODULE=x.spv -DHEADER=x.h -DSYMBOL=x -P embed.cmake: a SPIR-V module as `const uint32_t x[]`.
file(READ ${MODULE} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
string(REGEX REPLACE "(0x........,0x........,0x........,0x........,0x........,0x........,0x........,0x........,)" "    \\1\n" words "${words}")
file(WRITE ${HEADER} "#pragma once\nconst uint32_t ${SYMBOL}[] = {\n${words}\n};\n")
