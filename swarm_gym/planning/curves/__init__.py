"""Curves that robots with a turning circle can follow: compiled pieces, maps, searches and shortening."""
