//! Picture against picture (STUB, helper "oracle" writes it).
