// What terms mean, in the words of help TERM.
import terms from '../terms.json';

import {Glossary} from './glossary.js';

const glossary = new Glossary(terms);

export const meaningOf = (heading) => glossary.meaningOf(heading);
export const termsIn = (sentence) => glossary.termsIn(sentence);
