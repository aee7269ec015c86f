//! Coverage of a pixel footprint by rachis, barbs and barbules. Pure maths: no app, no GPU.
