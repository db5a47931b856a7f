:- module(json, [json_write_dict/3]).

/** <module> JSON, as far as answers.pl needs it: SWI-Prolog for WebAssembly comes without library(http/json)
*/

:- use_module(library(apply)).
:- use_module(library(pairs)).

%!  json_write_dict(+Stream, +Value, +Options) is det.
%
%   Writes dicts, lists, numbers, null, true and false; all else as a string. Options are ignored.

json_write_dict(Stream, Value, _) :- json_text(Value, Text), write(Stream, Text).

json_text(Value, Text) :- is_dict(Value), !,
    dict_pairs(Value, _, Pairs), maplist(member_text, Pairs, Texts), in_brackets('{', '}', Texts, Text).
json_text(Value, Text) :- is_list(Value), !, maplist(json_text, Value, Texts), in_brackets('[', ']', Texts, Text).
json_text(Value, Value) :- number(Value), !.
json_text(Value, Value) :- atom(Value), memberchk(Value, [null,true,false]), !.
json_text(Value, Text) :-
    term_to_string(Value, String), string_chars(String, Chars),
    maplist(json_char, Chars, Texts), atomic_list_concat(Texts, Inner), atomic_list_concat(['"',Inner,'"'], Text).

term_to_string(Value, String) :- ( text(Value) -> atom_string(Value, String) ; term_string(Value, String) ).

text(Value) :- ( atom(Value) ; string(Value) ), !.

member_text(Key-Value, Text) :- json_text(Key, Name), json_text(Value, Inner), atomic_list_concat([Name,':',Inner], Text).

in_brackets(Open, Close, Texts, Text) :-
    atomic_list_concat(Texts, ',', Inner), atomic_list_concat([Open,Inner,Close], Text).

json_char('"', '\\"')  :- !.
json_char('\\', '\\\\') :- !.
json_char(Char, Text)  :- char_code(Char, Code), Code < 32, !, format(atom(Text), '\\u~|~`0t~16r~4+', [Code]).
json_char(Char, Char).
