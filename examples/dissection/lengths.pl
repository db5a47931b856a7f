:- include('home/sizes.pl').
:- include('home/lengths.pl').
:- include('home/furniture.pl').
