"""Stores of blocks of named arrays: their marks, the groups and files that they are made of, the states in marks."""

from nonholo.io.blocks._block_store import BEFORE, BlockStore, Layout, Piece, make_marks, new_blocks
from nonholo.io.blocks._checkpoints import checkpoint_of, said_of
from nonholo.io.blocks._groups import create_array, edit_attributes, new_group, write_whole
