"""Everyday names of rooms in six languages mean the types that people mean by them."""

import re
import unicodedata
from collections import Counter
from typing import Any

import pytest

from vitruvius.logic.grammar import find
from vitruvius.logic.readers.types import meant, table, uses

NAMES = {
    "English": {
        "hall": "Entrance Hall, Entry, Foyer, Lobby, Mudroom, Vestibule",
        "corridor": "Hallway, Corridor, Landing, Passage",
        "living": "Living Room, Lounge, Family Room, Sitting Room, Great Room",
        "dining": "Dining Room, Dining Area, Breakfast Room",
        "kitchen": "Kitchen, Kitchenette",
        "bedroom": "Bedroom 1, Bed 2, Master Bedroom, Guest Room, Nursery, Kids Room, Primary Bedroom",
        "bathroom": "Bathroom, Bath, Shower Room, Family Bathroom, Ensuite, Kids Bath, Master Bath, Wet Room",
        "wc": "WC, Toilet, Guest WC, Powder Room, Half Bath",
        "storage": "Storage, Closet, Walk-in Closet, Pantry, Utility, Laundry Room, Larder, Cloakroom",
        "study": "Study, Office, small office, Home Office, Library, Den",
        "outside": "Balcony, Terrace, Garage, Double Garage, Patio, Deck, Carport, Garden",
        "": "Room 3, Sauna, Stairs, Attic, Hobby Room, Kitchen storage",
    },
    "German": {
        "hall": "Diele, Eingang, Windfang, Vorraum, Vorzimmer, Entree, Eingangsbereich",
        "corridor": "Flur, Flur OG, Gang, Korridor, Verteiler",
        "living": "Wohnzimmer, Wohnen, Wohnraum, Stube, WZ",
        "dining": "Esszimmer, Essen, Essplatz, Speisezimmer",
        "kitchen": "Küche, Kueche, Kuche, Kochen, Kochnische",
        "bedroom": "Schlafzimmer, Schlafen, Schlafzimmer Eltern, Elternschlafzimmer, Kinderzimmer 2, Kind 1,"
        "Kind, Eltern, Gästezimmer, Gast, SZ",
        "bathroom": "Bad, Badezimmer, Duschbad, Dusche, Bad/WC, Bad Eltern, Elternbad, Gästebad, DU/WC",
        "wc": "WC, Gäste-WC, Gaeste-WC, Gäste WC, Toilette, G-WC",
        "storage": "Abstellraum, Abst., AR, Abstellkammer, HWR, Hauswirtschaftsraum, HAR, Technik, Ankleide,"
        "Speisekammer, Vorrat, Garderobe, Waschküche, Heizung, Keller",
        "study": "Arbeitszimmer, Büro, kleines Büro, Arbeiten, Bibliothek",
        "outside": "Balkon, Terrasse, Dachterrasse, Loggia, Garage, Carport, Doppelgarage, Schacht, Luftraum",
        "": "Zimmer 1, Raum, Treppe, Treppenhaus, Hobbyraum, Wintergarten",
    },
    "Dutch": {
        "hall": "Hal, Entree, Inkomhal, Tochtportaal, Voorportaal",
        "corridor": "Gang, Overloop, Verkeersruimte",
        "living": "Woonkamer, Zitkamer, Leefruimte, Huiskamer",
        "dining": "Eetkamer, Eethoek",
        "kitchen": "Keuken, Open keuken, Kookhoek",
        "bedroom": "Slaapkamer, Slaapkamer 3, Ouderslaapkamer, Kinderkamer, Logeerkamer, Slaapk. 1,"
        "Hoofdslaapkamer",
        "bathroom": "Badkamer, Badkamer 2, Douche, Doucheruimte",
        "wc": "Toilet, WC, Toiletruimte, Gastentoilet",
        "storage": "Berging, Bijkeuken, Kast, Inloopkast, Wasruimte, Washok, Meterkast, CV-ruimte,"
        "Technische ruimte",
        "study": "Werkkamer, Studeerkamer, Kantoor",
        "outside": "Balkon, Terras, Dakterras, Tuin, Garage, Schuur, Vide, Loggia",
        "": "Kamer 1, Zolder, Trap, Hobbykamer, Kelder",
    },
    "Finnish": {
        "hall": "Eteinen, ET, Tuulikaappi, TK, Aula",
        "corridor": "Käytävä, KÄYT",
        "living": "Olohuone, OH, Tupa",
        "dining": "Ruokailu, Ruokailutila, RT, RUOK",
        "kitchen": "Keittiö, K, KT, Keittotila, Avokeittiö",
        "bedroom": "Makuuhuone, MH, MH1, MH 2, Lastenhuone, Vierashuone",
        "bathroom": "Kylpyhuone, KH, KPH, PH, Pesuhuone, KH/WC, Suihku",
        "wc": "WC, Vessa, Erillinen WC",
        "storage": "Vaatehuone, VH, Varasto, VAR, Kodinhoitohuone, KHH, Tekninen tila",
        "study": "Työhuone, TYÖH, Kirjasto, Toimisto",
        "outside": "Parveke, PARV, Terassi, Piha, Autotalli, AT, Autokatos",
        "": "Huone, Sauna, S, Portaat, Takkahuone",
    },
    "French": {
        "hall": "Entrée, Hall d'entrée, Vestibule, Sas",
        "corridor": "Couloir, Dégagement, Dgt, Palier",
        "living": "Séjour, Salon, Pièce de vie, Salle de séjour, Sejour",
        "dining": "Salle à manger, Coin repas",
        "kitchen": "Cuisine, Coin cuisine, Cuisine ouverte",
        "bedroom": "Chambre, Chambre 1, Ch. 2, Chambre parentale, Suite parentale, Chambre d'amis,"
        "Chambre enfants",
        "bathroom": "Salle de bain, Salle de bains, SdB, SDB 2, Salle d'eau, SDE, Douche",
        "wc": "WC, Toilettes, WC invités",
        "storage": "Placard, Dressing, Cellier, Buanderie, Rangement, Débarras, Rgt, Chaufferie",
        "study": "Bureau, Bibliothèque, Petit bureau",
        "outside": "Balcon, Terrasse, Jardin, Garage, Loggia, Véranda",
        "": "Pièce, Escalier, Cave, Grenier, Mezzanine",
    },
    "Spanish": {
        "hall": "Entrada, Recibidor, Vestíbulo, Hall",
        "corridor": "Pasillo, Distribuidor",
        "living": "Salón, Sala, Sala de estar, Estar, Salon",
        "dining": "Comedor",
        "kitchen": "Cocina, Cocina americana",
        "bedroom": "Dormitorio, Dormitorio 1, Dorm. 2, Dormitorio principal, Habitación, Alcoba,"
        "Habitacion 3",
        "bathroom": "Baño, Baño 1, Cuarto de baño, Baño principal, Ducha, Bano",
        "wc": "Aseo, Servicio",
        "storage": "Lavadero, Despensa, Trastero, Armario, Vestidor, Almacén, Tendedero",
        "study": "Despacho, Estudio, Oficina",
        "outside": "Balcón, Terraza, Jardín, Patio, Garaje, Porche",
        "": "Escalera, Buhardilla, Sótano",
    },
}  # fmt: skip
"""Names of rooms for each language and type."""


@pytest.mark.parametrize("language", NAMES)
def test_the_usual_room_names_of_a_language_are_known(language: str) -> None:
    names = [(name.strip(), kind) for kind, some in NAMES[language].items() for name in some.split(",")]
    assert len(names) >= 40
    assert {name: meant([name]) for name, _ in names} == {name: (kind, True) for name, kind in names}
    assert {name: meant([name.upper()])[0] for name, _ in names} == dict(names)


@pytest.mark.parametrize(
    ("name", "types"),
    [
        ("Wohnen/Essen/Kochen", {"living", "dining", "kitchen"}),
        ("Wohn-/Esszimmer", {"living", "dining"}),
        ("Wohn-Essbereich", {"living", "dining"}),
        ("Koch-/Essbereich", {"kitchen", "dining"}),
        ("Wohnküche", {"living", "kitchen"}),
        ("Kitchen / Dining / Living", {"living", "dining", "kitchen"}),
        ("Kitchen/Diner", {"kitchen", "dining"}),
        ("OH+K", {"living", "kitchen"}),
        ("K/RT", {"kitchen", "dining"}),
        ("Tupakeittiö", {"living", "kitchen"}),
        ("Cuisine ouverte sur séjour", {"kitchen", "living"}),
        ("Salon et salle à manger", {"living", "dining"}),
        ("Salón-comedor", {"living", "dining"}),
        ("Cocina comedor", {"kitchen", "dining"}),
        ("Woonkamer met open keuken", {"living", "kitchen"}),
        ("Bad/WC", {"bathroom"}),
        ("Bedroom with bath", {"bedroom"}),
    ],
)
def test_a_room_of_several_uses_has_the_types_of_all(name: str, types: set[str]) -> None:
    assert {*uses([name])} == types


@pytest.mark.parametrize(
    "name", ["Ballroom", "Kindergarten", "101", "R3", "et", "k", "x" * 10_000, "部屋", "🛏️"]
)
def test_a_word_of_no_type_is_not_guessed(name: str) -> None:
    assert meant([name]) == ("", False)


@pytest.mark.parametrize("form", ["NFC", "NFD", "NFKD"])
def test_a_word_means_its_type_however_unicode_composes_it(form: Any) -> None:
    assert meant([unicodedata.normalize(form, "Küche")]) == ("kitchen", True)
    assert meant(["部屋", "🛏️", "Gäste-WC"]) == ("wc", True)


def test_the_table_has_each_word_once_and_types_of_home_alone() -> None:
    words = Counter(word.casefold() for some in table().types.values() for word in some)
    assert [word for word, number in words.items() if number > 1] == []
    [declared] = re.findall(
        r"^type\((.*)\)\.", "\n".join(file.read_text() for file in find("home").own), re.M
    )
    kinds = {kind for key in table().types for kind in key.split("+")} | table().open.keys()
    assert kinds == {*declared.split("; "), "", "outside"}
