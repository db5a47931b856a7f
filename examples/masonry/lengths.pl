:- include('home/sizes.pl').
:- include('home/furniture.pl').
:- include('home/lengths.pl').

wall_thickness(inner, 0.12).
wall_thickness(outer, 0.36).
